//! What reading an OBJ file leaves out or changes beside what other formats do too.

use crate::document::notice::{Kind, UNKNOWN_STATEMENT};

pub(super) static DANGLING_INDEX: Kind =
    ("dangling-index", "indices of texture coordinates or normals that the file does not have, left out");
pub(super) static MIXED_CORNERS: Kind =
    ("mixed-corners", "faces of which only some corners have a texture coordinate or normal; it is left out");
pub(super) static VERTEX_WEIGHT: Kind =
    ("vertex-weight-ignored", "vertices with a weight (w) other than 1, which has no meaning here");
pub(super) static TEXTURE_DEPTH: Kind =
    ("texture-depth-ignored", "texture coordinates with a third component, which is left out");
pub(super) static EXTRA_NUMBERS: Kind = ("extra-numbers-ignored", "statements with more numbers than they take");
pub(super) static SMOOTHING_GROUPS: Kind =
    ("smoothing-groups-merged", "groups with several smoothing groups, which are not kept");
pub(super) static NAME_NOT_UTF8: Kind = ("name-not-utf8", "names that are not UTF-8, read with replacement characters");

/// The kind that a statement of no use to a triangle mesh belongs to.
pub(super) fn of_ignored_statement(keyword: &[u8]) -> &'static Kind {
    match keyword {
        b"l" => &("lines-ignored", "line elements (l) left out"),
        b"p" => &("points-ignored", "point elements (p) left out"),
        b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim" | b"hole"
        | b"scrv" | b"sp" | b"end" | b"con" | b"bsp" | b"bzp" | b"cdc" | b"cdp" | b"res" => {
            &("free-form-ignored", "statements of free-form curves and surfaces left out")
        }
        b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"maplib" | b"usemap" | b"shadow_obj" | b"trace_obj"
        | b"ctech" | b"stech" | b"mg" => &("display-ignored", "display and render statements left out"),
        _ => &UNKNOWN_STATEMENT,
    }
}
