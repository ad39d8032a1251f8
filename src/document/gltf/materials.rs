//! Materials of another format in the tree of a new file.

use crate::document::json_tree::Value;

use super::json::object;
use super::write::array;
use crate::document::lookup::image_type;
use crate::document::material::{Material, Materials};

/// A material as some primitives use it: glTF forbids textures where there are no coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Use<'a> {
    name: &'a str,
    is_bare: bool,
}

impl<'a> Use<'a> {
    /// The material called `name` for primitives that have texture coordinates or not.
    pub(super) fn new(name: &'a str, has_texcoords: bool, materials: &Materials) -> Self {
        let has_images =
            |m: &Material| [m.base_color_image, m.normal_image, m.emissive_image].iter().any(Option::is_some);
        Self { name, is_bare: !has_texcoords && materials.find(name).is_some_and(has_images) }
    }
}

/// Adds a material for each of `uses`, and their textures and images; the content of the images
/// in the order of the tree.
pub(super) fn add<'a>(tree: &mut Value, uses: &[Use<'_>], materials: &'a Materials) -> Vec<&'a [u8]> {
    let mut textures = Textures { numbers: vec![None; materials.images.len()], images: Vec::new(), materials };
    let list: Vec<Value> = uses
        .iter()
        .map(|Use { name, is_bare }| match materials.find(name) {
            Some(material) if *is_bare => to_json(&material.without_images(), tree, &mut textures),
            Some(material) => to_json(material, tree, &mut textures),
            None => to_json(&Material::new((*name).to_owned()), tree, &mut textures),
        })
        .collect();
    if !list.is_empty() {
        tree["materials"] = list.into();
    }
    textures.images
}

/// Textures made so far, by the image they show.
struct Textures<'a> {
    numbers: Vec<Option<usize>>,
    images: Vec<&'a [u8]>,
    materials: &'a Materials,
}

impl Textures<'_> {
    /// A reference to the texture of `image`, which is made if need be.
    fn reference(&mut self, tree: &mut Value, image: usize) -> Option<Value> {
        let file = self.materials.images.get(image)?;
        let number = match self.numbers[image] {
            Some(number) => number,
            None => {
                let name = file.name.rsplit(['/', '\\']).next().unwrap_or_default();
                let name = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
                array(tree, "images").push(object(vec![("name", name.into())]));
                let is_webp = image_type(&file.bytes) == Some("image/webp");
                let number = self.images.len();
                self.images.push(&file.bytes);
                if tree.get("samplers").is_none() {
                    // Textures of other formats repeat.
                    let keys = [("magFilter", 9729), ("minFilter", 9987), ("wrapS", 10497), ("wrapT", 10497)];
                    tree["samplers"] = vec![object(keys.map(|(key, code)| (key, code.into())).to_vec())].into();
                }
                let source = ("source", number.into());
                let source = if is_webp { ("extensions", object(vec![(WEBP, object(vec![source]))])) } else { source };
                array(tree, "textures").push(object(vec![("sampler", 0.into()), source]));
                if is_webp && tree.get("extensionsUsed").is_none() {
                    tree["extensionsUsed"] = vec![WEBP].into();
                    tree["extensionsRequired"] = vec![WEBP].into();
                }
                self.numbers[image] = Some(number);
                number
            }
        };
        Some(object(vec![("index", number.into())]))
    }
}

const WEBP: &str = "EXT_texture_webp";

fn to_json(material: &Material, tree: &mut Value, textures: &mut Textures<'_>) -> Value {
    let surface =
        object(vec![("metallicFactor", material.metallic.into()), ("roughnessFactor", material.roughness.into())]);
    let mut out = object(vec![("name", material.name.as_str().into()), ("pbrMetallicRoughness", surface)]);
    if material.base_color != [1.0; 4] {
        out["pbrMetallicRoughness"]["baseColorFactor"] = material.base_color.to_vec().into();
    }
    if material.emissive != [0.0; 3] {
        out["emissiveFactor"] = material.emissive.to_vec().into();
    }
    if material.base_color[3] < 1.0 || material.has_alpha_image {
        out["alphaMode"] = "BLEND".into();
    }
    let mut put = |image: Option<usize>, place: &mut dyn FnMut(Value)| {
        if let Some(reference) = image.and_then(|image| textures.reference(tree, image)) {
            place(reference);
        }
    };
    put(material.base_color_image, &mut |texture| out["pbrMetallicRoughness"]["baseColorTexture"] = texture);
    put(material.normal_image, &mut |texture| out["normalTexture"] = texture);
    put(material.emissive_image, &mut |texture| out["emissiveTexture"] = texture);
    out
}
