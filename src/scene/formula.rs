//! Boolean formulas over shapes, kept as a flat array of weighted gates.
//!
//! A gate is what the counter will be: a sum of its inputs' truths times their weights, compared with a threshold or taken
//! modulo 2. All operators are that one thing ("CSG" in ARCHITECTURE.md, section 2.2.3, where the running counter C is the sum):
//!
//! ```text
//! a & b & c   sum of 1,1,1   at least 3        a - b - c   sum of 1,-1,-1  at least 1
//! a | b | c   sum of 1,1,1   at least 1        !a          sum of -1       at least 0
//! a ^ b ^ c   sum of 1,1,1   odd               page        empty sum       at least 0
//! ```
//!
//! Chains of one operator become one gate while they are built, whichever side they grow on, so that a chain of 100,000 operands is
//! neither deep nor quadratic.

/// A node of a [`Formula`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Area(u32);

impl Area {
    /// Index into [`Formula::gates`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// An input of a gate with its weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Which area.
    pub area: Area,
    /// What its truth adds to the sum.
    pub weight: i32,
}

/// How a node gets its truth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Gate {
    /// The fill of the scene's shape of that index.
    Shape(u32),
    /// The weighted sum of the inputs is at least the threshold.
    AtLeast(i32, Vec<Input>),
    /// The sum of the inputs is odd.
    Odd(Vec<Input>),
}

/// Gates that refer to each other; there is no cycle.
#[derive(Clone, Debug, Default)]
pub struct Formula {
    gates: Vec<Gate>,
}

impl Formula {
    /// The gates. An input may stand before or behind the gate that uses it.
    pub fn gates(&self) -> &[Gate] {
        &self.gates
    }

    /// The fill of shape `index`.
    pub fn shape(&mut self, index: u32) -> Area {
        self.add(Gate::Shape(index))
    }

    /// True everywhere.
    pub fn everywhere(&mut self) -> Area {
        self.add(Gate::AtLeast(0, Vec::new()))
    }

    /// At least `k` of the areas hold.
    pub fn at_least(&mut self, k: i32, areas: &[Area]) -> Area {
        let inputs = unit(areas);
        self.add(Gate::AtLeast(k, inputs))
    }

    /// One of the areas holds; nowhere if there are none.
    pub fn any(&mut self, areas: &[Area]) -> Area {
        self.at_least(1, areas)
    }

    /// All of the areas hold; everywhere if there are none.
    pub fn all(&mut self, areas: &[Area]) -> Area {
        self.at_least(i32::try_from(areas.len()).expect("operands are limited"), areas)
    }

    /// An odd number of the areas hold.
    pub fn odd(&mut self, areas: &[Area]) -> Area {
        let inputs = unit(areas);
        self.add(Gate::Odd(inputs))
    }

    /// `area` without all of `others`.
    pub fn without(&mut self, area: Area, others: &[Area]) -> Area {
        let mut inputs = unit(&[area]);
        inputs.extend(others.iter().map(|&area| Input { area, weight: -1 }));
        self.add(Gate::AtLeast(1, inputs))
    }

    /// Where `area` does not hold.
    pub fn not(&mut self, area: Area) -> Area {
        self.add(Gate::AtLeast(0, vec![Input { area, weight: -1 }]))
    }

    /// How often each gate is an input within an area, and the area itself once more: 0 for those that it does not need.
    pub fn uses(&self, area: Area) -> Vec<u32> {
        let mut uses = vec![0_u32; self.gates.len()];
        let mut open = vec![area];
        while let Some(area) = open.pop() {
            let uses = &mut uses[area.index()];
            *uses += 1;
            if let (1, Gate::AtLeast(_, inputs) | Gate::Odd(inputs)) = (*uses, &self.gates[area.index()]) {
                open.extend(inputs.iter().map(|input| input.area));
            }
        }
        uses
    }

    /// From now on the area is the fill of shape `index`, wherever it is an input.
    pub fn becomes(&mut self, area: Area, index: u32) {
        self.gates[area.index()] = Gate::Shape(index);
    }

    fn add(&mut self, gate: Gate) -> Area {
        let area = Area(u32::try_from(self.gates.len()).expect("nodes are limited at the door"));
        self.gates.push(gate);
        area
    }
}

fn unit(areas: &[Area]) -> Vec<Input> {
    areas.iter().map(|&area| Input { area, weight: 1 }).collect()
}
