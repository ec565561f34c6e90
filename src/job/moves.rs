//! Parts of a model that are moved, and what of a picture that changes.

use std::ops::Range;

use glam::DVec3;

use super::{Kept, SolidOptions};
use crate::error::{Error, Kind, Result};
use crate::mesh::{FARTHEST, Model};
use crate::scene::Limits;
use crate::solid::change;

/// A part of a model, moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The part, counted from 0 in document order.
    pub part: usize,
    /// By how much: x, y and z in the model's coordinates.
    pub by: [f64; 3],
}

/// Most moves of a picture.
pub const MAX_MOVES: usize = 64;

impl Kept {
    /// The model with parts moved after they were put at their places; of a part that is named several times the moves add up. Nothing is read again, but what is the same is found anew.
    ///
    /// # Errors
    /// No such part; more than [`MAX_MOVES`]; a limit, or a place that is too far away.
    pub fn moved(&self, moves: &[Move], limits: &Limits) -> Result<Kept> {
        if moves.len() > MAX_MOVES {
            return Err(Error::parameter(format!("{} moves: give at most {MAX_MOVES}", moves.len())));
        }
        let mut model = Model::clone(&self.model);
        for Move { part, by } in moves {
            let parts = model.parts.len();
            let Some(moved) = model.parts.get_mut(*part) else {
                return Err(Error::parameter(format!("primitive {} is moved, and there are {parts}: give one of 1 to {parts}", part + 1)));
            };
            for (row, by) in moved.matrix.iter_mut().zip(by) {
                row[3] += by;
            }
            let far = |x: f64| x.is_nan() || x.abs() >= FARTHEST;
            if moved.mesh.points.iter().any(|p| crate::mesh::moved(&moved.matrix, *p).into_iter().any(far)) {
                let what = format!("primitive {} is moved too far away: its coordinates must stay below {FARTHEST:e}", part + 1);
                return Err(Error::input(Kind::Limit, what));
            }
        }
        Kept::new(&model, limits, &mut Vec::new())
    }

    /// The scanlines on which this model's picture can differ from that of another with the same parts, some of them moved: ascending, none next to another. On all others they are the
    /// same to the bit.
    ///
    /// # Errors
    /// Those of [`Job::solid`](super::Job::solid).
    pub fn changed(&self, from: &Kept, options: &SolidOptions) -> Result<Vec<Range<u32>>> {
        let header = options.header()?;
        let views = [from, self].map(|kept| kept.view(&options.setup));
        let needed: Vec<usize> = self.leaves.iter().map(|leaf| leaf.0).collect();
        let mut lines = change::lines(&from.body, &self.body, [&views[0], &views[1]], &options.sections, &needed);
        let Range { start, end } = header.lines;
        lines.iter_mut().for_each(|range| *range = range.start.max(start)..range.end.min(end));
        lines.retain(|range| range.start < range.end);
        Ok(lines)
    }
}

/// A move as it is written, `ID,x,y,z`: a primitive, counted from 1 in document order, and by how much.
///
/// # Errors
/// What to give.
pub fn movement(text: &str) -> std::result::Result<Move, String> {
    let wrong = || "give the number of a primitive and how far it goes, ID,x,y,z, such as 3,0,0,1.5".to_owned();
    let (id, by) = text.split_once(',').ok_or_else(wrong)?;
    let part = id.trim().parse::<u32>().ok().and_then(|id| id.checked_sub(1)).ok_or_else(wrong)?;
    let numbers: Option<Vec<f64>> = by.split(',').map(|x| x.trim().parse().ok()).collect();
    let by = DVec3::from_array(numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(wrong)?);
    if !by.is_finite() {
        return Err(wrong());
    }
    Ok(Move { part: part as usize, by: by.to_array() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_are_read() {
        assert_eq!(movement("3,0,-1.5,2e1"), Ok(Move { part: 2, by: [0.0, -1.5, 20.0] }));
        assert_eq!(movement(" 1, 0 ,0,1"), Ok(Move { part: 0, by: [0.0, 0.0, 1.0] }));
        for text in ["", "1", "0,1,2,3", "1,2,3", "1,2,3,4,5", "1,nan,0,0", "1,inf,0,0", "-1,0,0,0", "x,0,0,0", "99999999999,0,0,0"] {
            assert!(movement(text).is_err(), "{text}");
        }
    }
}
