//! Colours of facets in the attribute word of binary STL: 5 bits a channel, in two layouts.
//!
//! VisCAM and SolidView: blue in the low bits, red in the high ones, and bit 15 set where there is
//! a colour. Materialise Magics: red in the low bits, blue in the high ones, bit 15 set where there
//! is none and the colour of the whole holds, which the header gives after `COLOR=`.

/// Which of the layouts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum Scheme {
    /// No colours.
    #[default]
    None,
    /// As VisCAM and SolidView have it; white where there is no colour.
    VisCam,
    /// As Materialise Magics has it, with the colour of the whole, RGBA.
    Materialise([u8; 4]),
}

impl Scheme {
    /// By the header and the words of all facets.
    pub(super) fn of(header: &[u8], mut words: impl Iterator<Item = u16>) -> Self {
        const KEY: &[u8] = b"COLOR=";
        if let Some(at) = header.windows(KEY.len()).position(|window| window == KEY)
            && let Some(&[r, g, b, a]) = header.get(at + KEY.len()..at + KEY.len() + 4)
        {
            return Self::Materialise([r, g, b, a]);
        }
        if words.any(|word| word & 0x8000 != 0) { Self::VisCam } else { Self::None }
    }

    /// RGBA, each 0 to 1.
    pub(super) fn color(self, word: u16) -> [f32; 4] {
        let channel = |shift: u32| f32::from(word >> shift & 31) / 31.0;
        match self {
            Self::VisCam if word & 0x8000 != 0 => [channel(10), channel(5), channel(0), 1.0],
            Self::Materialise(_) if word & 0x8000 == 0 => [channel(0), channel(5), channel(10), 1.0],
            Self::Materialise(whole) => whole.map(|c| f32::from(c) / 255.0),
            Self::VisCam | Self::None => [1.0; 4],
        }
    }

    /// The word for a colour; the nearest there is.
    pub(super) fn word(self, color: [f32; 4]) -> u16 {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
        let [r, g, b] = [color[0], color[1], color[2]].map(|c| (c.clamp(0.0, 1.0) * 31.0).round() as u16);
        match self {
            Self::None => 0,
            // White was left to the program that shows it.
            Self::VisCam if color == [1.0; 4] => 0,
            Self::VisCam => 0x8000 | r << 10 | g << 5 | b,
            Self::Materialise(_) if color == self.color(0x8000) => 0x8000,
            Self::Materialise(_) => b << 10 | g << 5 | r,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_kept() {
        let whole = Scheme::Materialise([10, 20, 30, 255]);
        for word in 0..0x8000_u16 {
            let seen = Scheme::VisCam.color(word | 0x8000);
            let kept = if seen == [1.0; 4] { 0 } else { word | 0x8000 };
            assert_eq!(Scheme::VisCam.word(seen), kept);
            assert_eq!(whole.word(whole.color(word)), word);
        }
        assert_eq!(whole.word(whole.color(0x8000)), 0x8000);
    }

    #[test]
    fn the_layouts_are_told_apart() {
        assert_eq!(Scheme::of(b"x", [0, 5].into_iter()), Scheme::None);
        assert_eq!(Scheme::of(b"x", [0, 0xFC00].into_iter()), Scheme::VisCam);
        assert_eq!(Scheme::of(b"aCOLOR=\x01\x02\x03\x04", [].into_iter()), Scheme::Materialise([1, 2, 3, 4]));
        assert_eq!(Scheme::VisCam.color(0xFC00), [1.0, 0.0, 0.0, 1.0], "red in the high bits");
        assert_eq!(Scheme::Materialise([0; 4]).color(31), [1.0, 0.0, 0.0, 1.0], "red in the low bits");
    }
}
