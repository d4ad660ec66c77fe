//! The overloads of `hash`: lookup3 over the bits of numbers, FarmHash over the bytes of strings.

use crate::math::noise::lookup3::{hash1, hash2, hash3, hash4};

/// `hash(int)`.
#[inline(always)]
pub fn hash_int(u: i32) -> i32 {
    hash1(u as u32) as i32
}

/// `hash(float)`, of the bits: the two zeros differ.
#[inline(always)]
pub fn hash_float(u: f32) -> i32 {
    hash1(u.to_bits()) as i32
}

/// `hash(float, float)`.
#[inline(always)]
pub fn hash_float2(u: f32, v: f32) -> i32 {
    hash2(u.to_bits(), v.to_bits()) as i32
}

/// `hash(point)`.
#[inline(always)]
pub fn hash_point(x: f32, y: f32, z: f32) -> i32 {
    hash3(x.to_bits(), y.to_bits(), z.to_bits()) as i32
}

/// `hash(point, float)`.
#[inline(always)]
pub fn hash_point_float(x: f32, y: f32, z: f32, t: f32) -> i32 {
    hash4(x.to_bits(), y.to_bits(), z.to_bits(), t.to_bits()) as i32
}

/// `hash(string)`: the low 32 bits of FarmHash64, 0 for the empty string.
pub fn hash_string(s: &str) -> i32 {
    if s.is_empty() { 0 } else { farmhash::hash64(s.as_bytes()) as i32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_have_the_numbers_of_osl() {
        assert_eq!(hash_int(42), 778167589);
        assert_eq!(hash_float(0.5), -71661746);
        assert_eq!(hash_float2(0.5, 1.5), 854135879);
        assert_eq!(hash_point(0.5, 1.5, 2.5), 880321024);
        assert_eq!(hash_point_float(0.5, 1.5, 2.5, 3.5), 1931328705);
        assert_eq!(hash_string("Hello World!"), -16050688);
        assert_eq!(hash_string(""), 0);
    }
}
