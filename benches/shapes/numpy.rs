//! The draws of numpy's `default_rng(seed)`, bit for bit, so that workloads first made with numpy can be made without it.
//!
//! The seed is hashed to 256 bits by `SeedSequence` (a pool of four words, mixed as in O'Neill's seed_seq_fe128); they are the
//! state and the increment of PCG64 (O'Neill 2014: a 128-bit linear congruential generator, output by XSL-RR). A double takes
//! the top 53 bits of an output; a bounded integer is drawn by Lemire's multiplication from half an output, whose other half
//! is kept for the next.

/// A generator in the state of `numpy.random.default_rng(seed)` after as many draws.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u128,
    increment: u128,
    half: Option<u32>,
}

const MULTIPLIER: u128 = 0x2360_ED05_1FC6_5DA4_4385_DF64_9FCC_F645;

impl Rng {
    /// `default_rng(seed)`.
    pub fn new(seed: u32) -> Rng {
        let [state, increment] = seed_sequence(seed);
        let mut rng = Rng { state: 0, increment: increment << 1 | 1, half: None };
        rng.step();
        rng.state = rng.state.wrapping_add(state);
        rng.step();
        rng
    }

    /// `random()`: in `0..1`.
    pub fn random(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// `uniform(low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }

    /// `integers(low, high)` for a range of less than 2^32.
    pub fn integers(&mut self, low: i64, high: i64) -> i64 {
        let range = u32::try_from(high - low).expect("a range of less than 2^32");
        let threshold = range.wrapping_neg() % range;
        loop {
            let product = u64::from(self.next_u32()) * u64::from(range);
            if product as u32 >= threshold {
                return low + (product >> 32) as i64;
            }
        }
    }

    /// `random(n)`.
    pub fn randoms(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.random()).collect()
    }

    /// `uniform(low, high, n)`.
    pub fn uniforms(&mut self, low: f64, high: f64, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.uniform(low, high)).collect()
    }

    fn step(&mut self) {
        self.state = self.state.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
    }

    fn next_u64(&mut self) -> u64 {
        self.step();
        ((self.state >> 64) as u64 ^ self.state as u64).rotate_right((self.state >> 122) as u32)
    }

    fn next_u32(&mut self) -> u32 {
        self.half.take().unwrap_or_else(|| {
            let both = self.next_u64();
            self.half = Some((both >> 32) as u32);
            both as u32
        })
    }
}

/// `SeedSequence(seed).generate_state(4, uint64)`, as two numbers of 128 bits, high half first.
fn seed_sequence(seed: u32) -> [u128; 2] {
    let mut constant = 0x43b0_d7e5u32;
    let mut hash = |value: u32| {
        let value = value ^ constant;
        constant = constant.wrapping_mul(0x931e_8875);
        let value = value.wrapping_mul(constant);
        value ^ value >> 16
    };
    let mix = |x: u32, y: u32| {
        let value = x.wrapping_mul(0xca01_f9dd).wrapping_sub(y.wrapping_mul(0x4973_f715));
        value ^ value >> 16
    };
    let mut pool = [seed, 0, 0, 0].map(&mut hash);
    for source in 0..4 {
        for target in (0..4).filter(|&target| target != source) {
            pool[target] = mix(pool[target], hash(pool[source]));
        }
    }

    let mut constant = 0x8b51_f9ddu32;
    let mut words = pool.iter().cycle().map(|&word| {
        let value = word ^ constant;
        constant = constant.wrapping_mul(0x58f3_8ded);
        let value = value.wrapping_mul(constant);
        u64::from(value ^ value >> 16)
    });
    let mut word = || words.next().expect("the pool is cycled");
    let mut double = || u128::from(word() | word() << 32);
    [double() << 64 | double(), double() << 64 | double()]
}
