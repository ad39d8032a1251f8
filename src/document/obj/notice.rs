//! What reading leaves out or changes: one warning for each kind, with a count and the first line.

use crate::error::Warning;

/// A kind of warning. The order is the order in which they are reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Notice {
    Lines,
    Points,
    FreeForm,
    Display,
    Unknown,
    SmallFace,
    DegenerateFace,
    DegenerateTriangle,
    UntriangulatedFace,
    DanglingIndex,
    MixedCorners,
    VertexWeight,
    TextureDepth,
    ExtraNumbers,
    SmoothingGroups,
    NameNotUtf8,
}

/// Code and text of each notice, in the order of the enum; the count goes before the text.
const TEXTS: [(&str, &str); 16] = [
    ("lines-ignored", "line elements (l) left out"),
    ("points-ignored", "point elements (p) left out"),
    ("free-form-ignored", "statements of free-form curves and surfaces left out"),
    ("display-ignored", "display and render statements left out"),
    ("unknown-statement", "statements with an unknown keyword left out"),
    ("face-too-small", "faces with fewer than three corners left out"),
    ("degenerate-face", "faces with fewer than three distinct points left out"),
    ("degenerate-triangle", "triangles with coinciding corners left out of polygons"),
    ("polygon-not-simple", "polygons that cross themselves or are too intricate triangulated roughly"),
    ("dangling-index", "indices of texture coordinates or normals that the file does not have, left out"),
    ("mixed-corners", "faces of which only some corners have a texture coordinate or normal; it is left out"),
    ("vertex-weight-ignored", "vertices with a weight (w) other than 1, which has no meaning here"),
    ("texture-depth-ignored", "texture coordinates with a third component, which is left out"),
    ("extra-numbers-ignored", "statements with more numbers than they take"),
    ("smoothing-groups-merged", "groups with several smoothing groups, which are not kept"),
    ("name-not-utf8", "names that are not UTF-8, read with replacement characters"),
];

impl Notice {
    /// The kind that a statement of no use to a triangle mesh belongs to.
    pub(super) fn of_ignored_statement(keyword: &[u8]) -> Self {
        match keyword {
            b"l" => Self::Lines,
            b"p" => Self::Points,
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim"
            | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"bsp" | b"bzp" | b"cdc" | b"cdp" | b"res" => {
                Self::FreeForm
            }
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"maplib" | b"usemap" | b"shadow_obj" | b"trace_obj"
            | b"ctech" | b"stech" | b"mg" => Self::Display,
            _ => Self::Unknown,
        }
    }
}

/// How often each notice was met, and where first.
#[derive(Debug, Default)]
pub(super) struct Notices {
    counts: [usize; TEXTS.len()],
    first_lines: [usize; TEXTS.len()],
}

impl Notices {
    /// Notes one more.
    pub(super) fn count(&mut self, notice: Notice, line: usize) {
        let at = notice as usize;
        if self.counts[at] == 0 {
            self.first_lines[at] = line;
        }
        self.counts[at] += 1;
    }

    /// The warnings, for the file called `name`.
    pub(super) fn into_warnings(self, name: &str) -> Vec<Warning> {
        let met = TEXTS.iter().zip(self.counts.iter().zip(&self.first_lines)).filter(|(_, (count, _))| **count > 0);
        met.map(|((code, text), (count, line))| Warning {
            code,
            message: format!("{count} {text}; first in line {line}"),
            place: format!("{name}:{line}"),
        })
        .collect()
    }
}
