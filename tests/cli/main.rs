//! The program as a user meets it: what it says, what it leaves behind, how it ends.

#![allow(clippy::unwrap_used)] // all of this is tests

mod output;
mod pages;
mod reference;
mod signals;
mod solid;
mod support;
mod usage;
mod work;
