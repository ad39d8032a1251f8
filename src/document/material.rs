//! Materials that come with a model, in the terms of glTF's metallic-roughness model.

use std::collections::BTreeMap;

use super::NamedFile;
use super::lookup::{find_file, image_type, shorten};
use crate::error::Warning;

/// A material by its name, as groups refer to it. Colours are linear.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// As in [`super::GroupLabel::material`].
    pub name: String,
    /// Red, green, blue, alpha, each 0 to 1.
    pub base_color: [f32; 4],
    /// 0 to 1.
    pub metallic: f32,
    /// 0 to 1.
    pub roughness: f32,
    /// Red, green, blue, each 0 to 1.
    pub emissive: [f32; 3],
    /// Index in [`Materials::images`].
    pub base_color_image: Option<usize>,
    /// Index in [`Materials::images`] of tangent-space normals.
    pub normal_image: Option<usize>,
    /// Index in [`Materials::images`].
    pub emissive_image: Option<usize>,
    /// The base colour's image has an alpha that counts.
    pub has_alpha_image: bool,
}

impl Material {
    /// White and dull.
    pub(super) fn new(name: String) -> Self {
        Self {
            name,
            base_color: [1.0; 4],
            metallic: 0.0,
            roughness: 1.0,
            emissive: [0.0; 3],
            base_color_image: None,
            normal_image: None,
            emissive_image: None,
            has_alpha_image: false,
        }
    }

    /// The same where images have no place.
    pub(super) fn without_images(&self) -> Self {
        Self {
            base_color_image: None,
            normal_image: None,
            emissive_image: None,
            has_alpha_image: false,
            // White was to be multiplied by the image.
            emissive: if self.emissive_image.is_some() { [0.0; 3] } else { self.emissive },
            ..self.clone()
        }
    }
}

/// The materials of a file and the images they use.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Materials {
    /// By name; of several of one name the first counts.
    pub list: Vec<Material>,
    /// Each once.
    pub images: Vec<NamedFile>,
}

impl Materials {
    /// The material called `name`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Material> {
        self.list.iter().find(|material| material.name == name)
    }
}

/// Finds the images that materials name among the given files.
#[derive(Debug)]
pub(super) struct Images<'a> {
    files: &'a [NamedFile],
    /// The number of the image that each file is, if it is one.
    found: Vec<Option<usize>>,
    asked: BTreeMap<String, Option<usize>>,
    pub(super) images: Vec<NamedFile>,
    pub(super) warnings: Vec<Warning>,
}

/// Missing images beyond this are not told one by one.
const MOST_WARNINGS: usize = 20;

impl<'a> Images<'a> {
    pub(super) fn new(files: &'a [NamedFile]) -> Self {
        let (images, warnings) = (Vec::new(), Vec::new());
        Self { files, found: vec![None; files.len()], asked: BTreeMap::new(), images, warnings }
    }

    /// The number of the image that `files[by]` calls `name`; a warning if it cannot be had.
    pub(super) fn find(&mut self, name: &str, by: usize) -> Option<usize> {
        if let Some(known) = self.asked.get(name) {
            return *known;
        }
        let found = self.find_new(name, by);
        self.asked.insert(name.to_owned(), found);
        found
    }

    fn find_new(&mut self, name: &str, by: usize) -> Option<usize> {
        let mut warn = |code, message: &str| {
            if self.warnings.len() < MOST_WARNINGS {
                let place = self.files.get(by).map_or_else(String::new, |file| file.name.clone());
                self.warnings.push(Warning { code, message: format!("\"{}\" {message}", shorten(name)), place });
            }
        };
        let Some(file) = find_file(name, self.files, by) else {
            warn("missing-image", "was not given; the material is without it");
            return None;
        };
        if !matches!(image_type(&self.files[file].bytes), Some("image/png" | "image/jpeg" | "image/webp")) {
            warn("bad-image", "is neither PNG, JPEG nor WebP; the material is without it");
            return None;
        }
        let images = &mut self.images;
        Some(*self.found[file].get_or_insert_with(|| {
            images.push(self.files[file].clone());
            images.len() - 1
        }))
    }
}

/// Whether a PNG has one channel of grey, with or without alpha: heights and not normals.
pub(super) fn is_grey_png(bytes: &[u8]) -> bool {
    image_type(bytes) == Some("image/png") && matches!(bytes.get(25), Some(0 | 4))
}

/// Whether a PNG says that it has alpha.
pub(super) fn is_png_with_alpha(bytes: &[u8]) -> bool {
    image_type(bytes) == Some("image/png") && matches!(bytes.get(25), Some(4 | 6))
}
