//! From solids to what is seen of them: the same sweep as for plane shapes, and a count along depth.

pub mod body;
pub mod camera;
pub mod cut;
pub mod shade;
pub mod spans;
pub mod stage;
pub mod view;
