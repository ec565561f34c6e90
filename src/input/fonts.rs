//! The fonts that text is drawn with.
//!
//! One is built in (Noto Sans, under the SIL Open Font License, see `svg/font/OFL.txt`): it stands for every generic family and for whatever
//! is missing, so that the same document gives the same picture everywhere. Others are added on request.

use std::sync::{Arc, LazyLock};

use usvg::fontdb::{Database, Source};

use crate::error::{Error, Kind, Result};

/// The built-in font's family.
pub(super) const BUILT_IN: &str = "Noto Sans";

static BUILT_IN_ALONE: LazyLock<Fonts> = LazyLock::new(|| {
    let mut database = Database::new();
    database.load_font_source(Source::Binary(Arc::new(include_bytes!("svg/font/NotoSans-Regular.ttf"))));
    database.set_serif_family(BUILT_IN);
    database.set_sans_serif_family(BUILT_IN);
    database.set_cursive_family(BUILT_IN);
    database.set_fantasy_family(BUILT_IN);
    database.set_monospace_family(BUILT_IN);
    Fonts(Arc::new(database))
});

/// The built-in font and what is added to it. A clone is cheap.
#[derive(Clone, Debug)]
pub struct Fonts(pub(super) Arc<Database>);

impl Default for Fonts {
    fn default() -> Fonts {
        BUILT_IN_ALONE.clone()
    }
}

impl Fonts {
    /// Adds the font, or the collection of fonts, that a file holds (TrueType or OpenType).
    ///
    /// # Errors
    /// It holds none.
    pub fn add(&mut self, file: Vec<u8>) -> Result<()> {
        let faces = Arc::make_mut(&mut self.0).load_font_source(Source::Binary(Arc::new(file)));
        if faces.is_empty() {
            return Err(Error::input(Kind::Malformed, "no font that can be read: give a TrueType or OpenType file"));
        }
        Ok(())
    }

    /// A number that is another for other fonts: of those given, their bytes count; of those that are installed, their names.
    pub fn fingerprint(&self) -> u32 {
        let mut sum = crc32fast::Hasher::new();
        for face in self.0.faces() {
            sum.update(face.post_script_name.as_bytes());
            sum.update(&face.index.to_le_bytes());
            if let Source::Binary(bytes) = &face.source {
                sum.update((**bytes).as_ref());
            }
        }
        sum.finalize()
    }

    /// Adds the fonts that are installed: the picture then depends on the machine.
    pub fn add_system(&mut self) {
        Arc::make_mut(&mut self.0).load_system_fonts();
    }
}
