//! Every file of the fuzzers' corpora through its door, within a second each.

mod clock;
mod doors;

use std::path::Path;

#[test]
fn corpora_pass_their_doors() {
    for (name, door) in doors::DOORS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
        let mut files = 0;
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            let start = clock::cpu();
            door(&bytes);
            assert!((clock::cpu() - start).as_secs_f64() < 1.0, "{} took {:?}", path.display(), clock::cpu() - start);
            files += 1;
        }
        assert!(files > 0, "{} is empty", folder.display());
    }
}
