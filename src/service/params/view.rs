//! What a query asks of a kept model: a picture, with some of its primitives moved.

use serde::Serialize;
use utoipa::IntoParams;

use super::super::problem::Problem;
use super::{SolidParams, take};
use crate::job::{self, Move};

/// Primitives that are moved in a view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct MoveParams {
    /// A primitive that is moved, ID,x,y,z: its number, counted from 1 in document order, and by how much in the model's coordinates. May be given several times; moves of one primitive add up
    #[serde(default, rename = "move")]
    #[param(max_items = 64)]
    pub moves: Vec<String>,
    /// Only the lines that can differ from the picture with these moves instead, or with none if it is empty: from the first that can to the last, and one where none can. May be given several times; not with lines
    #[serde(default)]
    #[param(max_items = 64)]
    pub from: Vec<String>,
}

/// The query of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewParams {
    /// Of the picture.
    pub solid: SolidParams,
    /// Of the moves.
    pub moves: MoveParams,
}

impl ViewParams {
    /// Those of a query.
    ///
    /// # Errors
    /// Unknown names; values that are none of theirs.
    pub fn read(query: &str) -> Result<ViewParams, Problem> {
        let (moves, rest) = take(query, "move");
        let (from, rest) = take(&rest, "from");
        let solid = SolidParams::read(&rest)?;
        if solid.lines.is_some() && !from.is_empty() {
            return Err(Problem::malformed("lines and from both say which lines: give one of them"));
        }
        Ok(ViewParams { solid, moves: MoveParams { moves, from } })
    }
}

impl MoveParams {
    /// The moves.
    ///
    /// # Errors
    /// Values that are none.
    pub fn moves(&self) -> Result<Vec<Move>, Problem> {
        read("move", &self.moves)
    }

    /// The moves of the picture that the client has, if it has one.
    ///
    /// # Errors
    /// Values that are none.
    pub fn from(&self) -> Result<Option<Vec<Move>>, Problem> {
        match &self.from[..] {
            [] => Ok(None),
            [empty] if empty.is_empty() => Ok(Some(Vec::new())),
            from => read("from", from).map(Some),
        }
    }
}

fn read(name: &str, texts: &[String]) -> Result<Vec<Move>, Problem> {
    if texts.len() > job::MAX_MOVES {
        return Err(Problem::malformed(format!("{name} is given {} times: give at most {}", texts.len(), job::MAX_MOVES)));
    }
    let one = |text: &String| job::movement(text).map_err(|what| Problem::malformed(format!("{name} is {text:?}: {what}")));
    texts.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_stand_beside_what_is_asked_of_a_picture() {
        let params = ViewParams::read("imgsize=9,8&move=2,0,1,0&move=1,0.5,0,0&from=").unwrap();
        assert_eq!(params.solid.imgsize.as_deref(), Some("9,8"));
        assert_eq!(params.moves.moves().unwrap(), [Move { part: 1, by: [0.0, 1.0, 0.0] }, Move { part: 0, by: [0.5, 0.0, 0.0] }]);
        assert_eq!(params.moves.from().unwrap(), Some(Vec::new()));
        assert_eq!(ViewParams::read("").unwrap().moves.from().unwrap(), None);
        assert!(ViewParams::read("from=&lines=0..4").is_err());
        for query in ["from=1,0,0,0&from=", "from=x", "from=0,1,1,1"] {
            assert!(ViewParams::read(query).unwrap().moves.from().is_err(), "{query}");
        }
        assert!(ViewParams::read(&"move=1,0,0,0&".repeat(65)).unwrap().moves.moves().is_err());
    }
}
