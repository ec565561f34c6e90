//! From solids to what is seen of them: the same sweep as for plane shapes, and a count along depth.

mod active;
pub mod body;
mod boxes;
pub mod camera;
mod cells;
pub mod change;
pub mod cut;
mod same;
pub mod savings;
mod seen;
pub mod shade;
pub mod spans;
pub mod stage;
pub mod timers;
pub mod view;
