//! What reading leaves out or changes: one warning for each kind, with a count and the first place.

use crate::error::Warning;

/// The stable code of a kind, and the text that follows the count.
pub(super) type Kind = (&'static str, &'static str);

// What several formats have in common.
pub(super) static SMALL_FACE: Kind = ("face-too-small", "faces with fewer than three corners left out");
pub(super) static DEGENERATE_FACE: Kind = ("degenerate-face", "faces with fewer than three distinct points left out");
pub(super) static DEGENERATE_TRIANGLE: Kind =
    ("degenerate-triangle", "triangles with coinciding corners left out of polygons");
pub(super) static UNTRIANGULATED_FACE: Kind =
    ("polygon-not-simple", "polygons that cross themselves or are too intricate triangulated roughly");
pub(super) static UNKNOWN_STATEMENT: Kind = ("unknown-statement", "statements with an unknown keyword left out");

/// The kinds met so far, in the order they were met.
#[derive(Debug, Default)]
pub(super) struct Notices {
    met: Vec<Notice>,
}

#[derive(Debug)]
struct Notice {
    kind: &'static Kind,
    count: usize,
    first: String,
}

impl Notices {
    /// Notes one more of a kind, told by its code.
    #[inline(never)]
    pub(super) fn count(&mut self, kind: &'static Kind, place: &dyn Fn() -> String) {
        match self.met.iter_mut().find(|notice| notice.kind.0 == kind.0) {
            Some(notice) => notice.count += 1,
            None => self.met.push(Notice { kind, count: 1, first: place() }),
        }
    }

    /// The warnings.
    pub(super) fn into_warnings(self) -> Vec<Warning> {
        let warning = |Notice { kind: &(code, text), count, first }| Warning {
            code,
            message: format!("{count} {text}"),
            place: first,
        };
        self.met.into_iter().map(warning).collect()
    }
}
