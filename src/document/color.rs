//! sRGB and linear colour values, the same to the bit on every platform.
//!
//! PLY, OFF, STL, SMF and OBJ hold colours as a display takes them, glTF holds vertex colours and
//! factors linear. The transfer functions are those of IEC 61966-2-1. Their powers are taken by
//! square roots and Newton's method, because no `powf` gives equal bits native and in WebAssembly.

/// Linear light of an sRGB value; what is not between 0 and 1 stays as it is.
pub(super) fn to_linear(srgb: f32) -> f32 {
    let s = f64::from(srgb);
    if !(0.0..=1.0).contains(&s) {
        return srgb;
    }
    if s <= 0.04045 {
        return rounded(s / 12.92);
    }
    // x^2.4 = (x^12)^(1/5), which is below x^2.
    let x = (s + 0.055) / 1.055;
    let square = x * x;
    let fourth = square * square;
    rounded(root::<5>(fourth * fourth * fourth, square))
}

/// The sRGB value of linear light; inverse of [`to_linear`].
pub(super) fn to_srgb(linear: f32) -> f32 {
    let l = f64::from(linear);
    if !(0.0..=1.0).contains(&l) {
        return linear;
    }
    if l <= 0.003_130_8 {
        return rounded(l * 12.92);
    }
    // x^(1/2.4) = (x · x^(1/4))^(1/3), which is below x^(1/4).
    let fourth_root = l.sqrt().sqrt();
    rounded(1.055 * root::<3>(l * fourth_root, fourth_root) - 0.055)
}

/// The `N`th root of a positive number, from a guess above it: Newton's iteration then falls until
/// rounding stops it.
fn root<const N: usize>(value: f64, mut guess: f64) -> f64 {
    #[allow(clippy::cast_precision_loss)] // 3 or 5
    let n = N as f64;
    loop {
        let power = (1..N).fold(1.0, |product, _| product * guess);
        let next = guess - (guess - value / power) / n;
        if next >= guess || next.is_nan() {
            return guess;
        }
        guess = next;
    }
}

#[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
fn rounded(value: f64) -> f32 {
    value as f32
}

/// 0 to 1 as 0 to 255; anything else as the nearer end.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
pub(super) fn to_byte(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curves_are_those_of_the_standard_and_invert_each_other() {
        for step in 0..=2550_u16 {
            let srgb = f32::from(step) / 2550.0;
            let x = f64::from(srgb);
            let expected = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
            assert!((f64::from(to_linear(srgb)) - expected).abs() < 1e-7, "{step}");
            assert!((to_srgb(to_linear(srgb)) - srgb).abs() < 1e-6, "{step}");
        }
        assert_eq!((to_linear(0.0), to_linear(1.0), to_srgb(0.0), to_srgb(1.0)), (0.0, 1.0, 0.0, 1.0));
    }

    #[test]
    fn what_is_no_colour_stays_as_it_is() {
        for value in [f32::MAX, f32::MIN, 1e30, -1.0, 2.0] {
            assert_eq!((to_linear(value), to_srgb(value)), (value, value));
        }
    }
}
