//! Shapes and boolean expressions in, exact raster lines out.
//!
//! Everything is a [sweep](sweep::Sweep) that keeps a short ordered list of active edges, and a
//! [count](count::Counters) that is updated while that list is walked from left to right. No polygon
//! is ever intersected with another and no mask image is stored, so memory follows the drawing and
//! not the page.
//!
//! The modules are floors; imports point down only (`tests/floors.rs` keeps it so):
//!
//! ```text
//! 5  cli  main  service      arguments, files, signals; HTTP, stored jobs
//!    print                   sheets, printers, errands over IPP
//! 4  job                     bytes -> scene -> rows -> Write
//! 3  region  solid  input  encode   runs of a page; spans of a model; readers; writers
//! 2  edge  mesh  scene       edge builders; polyhedra; shapes, expression, page, limits
//! 1  sweep  shape            active edges in column order; paths, fill rules, strokes, flattening
//! 0  grid  line  count  bits  bounds  run  checksum  error
//! ```

pub mod bits;
pub mod bounds;
pub mod checksum;
pub mod count;
pub mod edge;
pub mod encode;
pub mod error;
pub mod grid;
pub mod input;
pub mod job;
pub mod line;
pub mod mesh;
#[cfg(feature = "print")]
pub mod print;
pub mod region;
pub mod run;
pub mod scene;
#[cfg(feature = "serve")]
pub mod service;
pub mod shape;
pub mod solid;
mod spread;
pub mod sweep;

/// The README's example, kept true.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
