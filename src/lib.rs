//! Decimesh: mesh simplification for 3D on the web.
//!
//! The modules stand in the order of the data:
//!
//! ```text
//! bytes → Document → Mesh → CollapseSequence → Mesh at a level → Document → bytes
//! ```
//!
//! [`document`] reads and writes files and keeps what it does not understand; [`mesh`] is the
//! indexed triangle set; [`simplify`] runs quadric edge collapse over it and records a
//! [`collapse_sequence`]; [`lod`] extracts the mesh at any triangle count or error from that
//! record; [`deviation`] measures how far such a mesh is from the original. Imports point
//! backwards along this line only.

pub mod error;
pub mod mesh;

pub mod collapse_sequence;
pub mod simplify;

pub mod lod;

pub mod deviation;

pub mod document;

#[cfg(target_arch = "wasm32")]
mod wasm;

pub use error::{Error, ErrorCode, Warning};
