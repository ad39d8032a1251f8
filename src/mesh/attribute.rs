//! A per-wedge attribute and how two of its values blend when their wedges merge.

/// How the value of a merged wedge follows from the two it came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blend {
    /// Linear in every component: texture coordinates, colours, morph-target deltas.
    Linear,
    /// Linear, then scaled to unit length: normals (3 components).
    Direction,
    /// The first three as [`Blend::Direction`], the fourth (handedness) from the nearer wedge.
    Tangent,
    /// All of it from the nearer wedge: feature ids and anything of unknown meaning.
    Nearest,
    /// Joint indices; blended together with the [`Blend::Weights`] that follows it in the list.
    Joints,
    /// Skin weights of the joints just before it in the list.
    Weights,
}

/// Values of one attribute for the wedges of one set.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    /// The file's name for it: `NORMAL`, `TEXCOORD_0`, `_FEATURE_ID_0`, `TARGET_1/POSITION`.
    pub name: String,
    /// Numbers per wedge, 1 to 16.
    pub components: usize,
    /// `components` numbers for each wedge of the set; integers are held exactly, normalised
    /// integers as the fraction they stand for.
    pub values: Vec<f32>,
    /// How merged values follow.
    pub blend: Blend,
}
