//! From solids to what is seen of them: the same sweep as for plane shapes, and a count along depth.

mod active;
mod average;
mod beside;
pub mod body;
mod boxes;
pub mod camera;
mod cells;
pub mod change;
mod corners;
pub mod cut;
pub mod glass;
pub mod look;
mod near;
pub mod outlines;
pub mod paint;
pub mod rows;
mod same;
pub mod savings;
mod seen;
pub mod shade;
pub mod smooth;
pub mod spans;
pub mod stage;
pub mod timers;
pub mod view;
