//! Material libraries (.mtl) of an OBJ file as glTF's metallic-roughness materials.
//!
//! | statement | becomes |
//! | --- | --- |
//! | `Kd`, `map_Kd` | base colour and its image; both multiply |
//! | `d`, `Tr` = 1 - d, `map_d` | alpha; `map_d` only if it is the image of `map_Kd` |
//! | `Ns` | roughness, if `Ks` is not black (see [`roughness`]) |
//! | `Ke`, `map_Ke` | emission and its image |
//! | `norm`, `map_Bump`, `bump` | normal map; an image in shades of grey is heights, and is left out |
//! | `Pr`, `Pm` | roughness and metalness as such |
//!
//! Colours are taken to be sRGB, as in most files. The rest has no counterpart and is left out
//! without a word: an OBJ file that is written still names its libraries.

use std::borrow::Cow;

use crate::document::NamedFile;
use crate::document::color::to_linear;
use crate::document::lookup::find_file;
use crate::document::material::{Images, Material, Materials, is_grey_png, is_png_with_alpha};
use crate::document::scan::Scanner;
use crate::document::sniff::decode_utf16;
use crate::error::Warning;

/// Missing libraries beyond this are not told one by one.
const MOST_WARNINGS: usize = 20;

/// Materials beyond this are no library any more.
const MOST_MATERIALS: usize = 65_536;

/// Reads the libraries that `files[main]` names, as far as they were given.
pub(super) fn read(files: &[NamedFile], main: usize, libraries: &[String]) -> (Materials, Vec<Warning>) {
    let mut images = Images::new(files);
    let mut list: Vec<Material> = Vec::new();
    let mut warnings = Vec::new();
    for library in libraries {
        let Some(file) = find_file(library, files, main) else {
            if warnings.len() >= MOST_WARNINGS {
                continue;
            }
            warnings.push(Warning {
                code: "missing-material-library",
                message: format!("\"{library}\" was not given; its materials are only names"),
                place: files.get(main).map_or_else(String::new, |file| file.name.clone()),
            });
            continue;
        };
        read_library(files, file, &mut images, &mut list);
        if list.len() >= MOST_MATERIALS {
            break;
        }
    }
    warnings.append(&mut images.warnings);
    (Materials { list, images: images.images }, warnings)
}

/// A material as it is read: what its statements say, before it is clear what they make together.
struct Draft {
    material: Material,
    diffuse: Option<[f32; 3]>,
    specular: [f32; 3],
    exponent: Option<f32>,
    roughness: Option<f32>,
    alpha_image: Option<usize>,
}

fn read_library(files: &[NamedFile], file: usize, images: &mut Images<'_>, list: &mut Vec<Material>) {
    let bytes = &files[file].bytes;
    let text = decode_utf16(bytes).unwrap_or(Cow::Borrowed(bytes));
    let mut scan = Scanner::new(&text);
    let mut draft: Option<Draft> = None;
    while !scan.is_at_end() && list.len() < MOST_MATERIALS {
        scan.skip_blanks();
        let keyword = scan.word().to_ascii_lowercase();
        if keyword == b"newmtl" {
            list.extend(draft.take().map(|draft| draft.finish(images)));
            let name = String::from_utf8_lossy(&scan.rest_of_line()).replace(|c: char| c.is_ascii_control(), " ");
            draft = Some(Draft {
                material: Material::new(name.trim_matches(' ').to_owned()),
                diffuse: None,
                specular: [0.0; 3],
                exponent: None,
                roughness: None,
                alpha_image: None,
            });
        } else if let Some(draft) = &mut draft {
            draft.statement(&keyword, &mut scan, images, file);
        }
        scan.finish_line();
    }
    list.extend(draft.map(|draft| draft.finish(images)));
}

impl Draft {
    /// Numbers that are none leave what they would set as it was.
    fn statement(&mut self, keyword: &[u8], scan: &mut Scanner<'_>, images: &mut Images<'_>, file: usize) {
        let material = &mut self.material;
        match keyword {
            b"kd" => self.diffuse = color(scan).or(self.diffuse),
            b"ks" => self.specular = color(scan).unwrap_or(self.specular),
            b"ke" => material.emissive = color(scan).map_or(material.emissive, |c| c.map(to_linear)),
            b"ns" => self.exponent = scan.next_number().ok().or(self.exponent),
            b"pr" => self.roughness = scan.next_number().ok().map(unit).or(self.roughness),
            b"pm" => material.metallic = scan.next_number().map_or(material.metallic, unit),
            b"d" => material.base_color[3] = scan.next_number().map_or(material.base_color[3], unit),
            b"tr" => material.base_color[3] = scan.next_number().map_or(material.base_color[3], |t| 1.0 - unit(t)),
            b"map_kd" => material.base_color_image = map(scan, images, file),
            b"map_ke" => material.emissive_image = map(scan, images, file),
            b"map_d" => self.alpha_image = map(scan, images, file),
            b"norm" | b"map_kn" | b"map_bump" | b"bump" => {
                let image = map(scan, images, file).filter(|&image| !is_grey_png(&images.images[image].bytes));
                material.normal_image = image.or(material.normal_image);
            }
            _ => {}
        }
    }

    fn finish(self, images: &Images<'_>) -> Material {
        let mut material = self.material;
        let has_image = material.base_color_image.is_some();
        // Black under an image is what some exporters write for "see the image".
        let diffuse = self.diffuse.filter(|c| !(has_image && *c == [0.0; 3])).unwrap_or([1.0; 3]);
        material.base_color[..3].copy_from_slice(&diffuse.map(to_linear));
        let shines = self.specular != [0.0; 3];
        material.roughness = self.roughness.unwrap_or_else(|| self.exponent.filter(|_| shines).map_or(1.0, roughness));
        if material.emissive_image.is_some() && material.emissive == [0.0; 3] {
            material.emissive = [1.0; 3];
        }
        material.has_alpha_image = self.alpha_image.is_some()
            && self.alpha_image == material.base_color_image
            && self.alpha_image.is_some_and(|image| is_png_with_alpha(&images.images[image].bytes));
        material
    }
}

/// The roughness of a Blinn–Phong lobe of exponent `n`: α² = 2 / (n + 2) (Walter et al.,
/// *Microfacet Models for Refraction*, 2007, section 5.2), and glTF's roughness is √α.
fn roughness(n: f32) -> f32 {
    unit((2.0 / (f64::from(n).max(0.0) + 2.0)).sqrt().sqrt() as f32)
}

fn unit(value: f32) -> f32 {
    value.clamp(0.0, 1.0)
}

/// `r g b`, or `r` for grey; `None` for `spectral` and `xyz`.
fn color(scan: &mut Scanner<'_>) -> Option<[f32; 3]> {
    let r = scan.next_number().ok()?;
    let g = scan.next_number().unwrap_or(r);
    let b = scan.next_number().unwrap_or(g);
    Some([r, g, b].map(unit))
}

/// The image of a `map_…` statement: what follows the options.
fn map(scan: &mut Scanner<'_>, images: &mut Images<'_>, file: usize) -> Option<usize> {
    let rest = scan.rest_of_line();
    let text = String::from_utf8_lossy(&rest);
    let name = without_options(&text);
    if name.is_empty() { None } else { images.find(name, file) }
}

/// `-bm 0.2 -o 1 1 my image.png` as `my image.png`.
pub(super) fn without_options(mut text: &str) -> &str {
    fn word(text: &str) -> (&str, &str) {
        let text = text.trim_ascii_start();
        text.split_at(text.find(|c: char| c.is_ascii_whitespace()).unwrap_or(text.len()))
    }
    loop {
        let (option, mut rest) = word(text);
        let (least, most) = match option.to_ascii_lowercase().as_str() {
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-texres" | "-bm" | "-boost" | "-type"
            | "-colorspace" => (1, 1),
            "-mm" => (2, 2),
            "-o" | "-s" | "-t" => (1, 3),
            _ => return text.trim_ascii(),
        };
        for number in 0..most {
            let (value, after) = word(rest);
            if number >= least && value.parse::<f32>().is_err() {
                break;
            }
            rest = after;
        }
        text = rest;
    }
}

/// The images that the text of a library names, for who has to find them.
pub(super) fn image_names(bytes: &[u8]) -> Vec<String> {
    let mut scan = Scanner::new(bytes);
    let mut names = Vec::new();
    while !scan.is_at_end() {
        scan.skip_blanks();
        let keyword = scan.word().to_ascii_lowercase();
        if matches!(&keyword[..], b"map_kd" | b"map_ke" | b"map_d" | b"map_bump" | b"bump" | b"norm" | b"map_kn") {
            let rest = scan.rest_of_line();
            let name = without_options(&String::from_utf8_lossy(&rest)).to_owned();
            if !name.is_empty() {
                names.push(name);
            }
        }
        scan.finish_line();
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_not_part_of_a_name() {
        for (text, name) in [
            ("a b.png", "a b.png"),
            ("-bm 0.5 a.png", "a.png"),
            ("-o 1 2 -s 1 1 1 -blendu on dir\\a b.png ", "dir\\a b.png"),
            ("-texres 512 -colorspace sRGB -o 0.1 diffuse.jpg", "diffuse.jpg"),
            ("-odd.png", "-odd.png"),
            ("-o", ""),
        ] {
            assert_eq!(without_options(text), name, "{text}");
        }
    }

    #[test]
    fn exponents_make_roughness() {
        assert_eq!((roughness(0.0), roughness(30.0)), (1.0, 0.5));
        assert!(roughness(1000.0) < 0.22 && roughness(-5.0) == 1.0 && roughness(f32::MAX) >= 0.0);
    }
}
