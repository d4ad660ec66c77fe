//! The integer hash under every noise: lookup3 by Bob Jenkins (2006), in the seeding that OSL uses.
//!
//! All arithmetic wraps. The functions differ only in how many words they take.

/// The seed of lookup3 for a message of `words` 32-bit words.
const fn seed(words: u32) -> u32 {
    0xdead_beef_u32.wrapping_add(words << 2).wrapping_add(13)
}

/// The reversible mixing of three words that lookup3 does after every three words of a longer message.
#[inline(always)]
pub fn mix(mut a: u32, mut b: u32, mut c: u32) -> (u32, u32, u32) {
    a = a.wrapping_sub(c) ^ c.rotate_left(4);
    c = c.wrapping_add(b);
    b = b.wrapping_sub(a) ^ a.rotate_left(6);
    a = a.wrapping_add(c);
    c = c.wrapping_sub(b) ^ b.rotate_left(8);
    b = b.wrapping_add(a);
    a = a.wrapping_sub(c) ^ c.rotate_left(16);
    c = c.wrapping_add(b);
    b = b.wrapping_sub(a) ^ a.rotate_left(19);
    a = a.wrapping_add(c);
    c = c.wrapping_sub(b) ^ b.rotate_left(4);
    b = b.wrapping_add(a);
    (a, b, c)
}

/// The last mixing of lookup3: three words in, one well-mixed word out.
#[inline(always)]
pub fn finish(mut a: u32, mut b: u32, mut c: u32) -> u32 {
    c = (c ^ b).wrapping_sub(b.rotate_left(14));
    a = (a ^ c).wrapping_sub(c.rotate_left(11));
    b = (b ^ a).wrapping_sub(a.rotate_left(25));
    c = (c ^ b).wrapping_sub(b.rotate_left(16));
    a = (a ^ c).wrapping_sub(c.rotate_left(4));
    b = (b ^ a).wrapping_sub(a.rotate_left(14));
    (c ^ b).wrapping_sub(b.rotate_left(24))
}

/// Hashes one word.
#[inline(always)]
pub fn hash1(x: u32) -> u32 {
    let s = seed(1);
    finish(s.wrapping_add(x), s, s)
}

/// Hashes two words.
#[inline(always)]
pub fn hash2(x: u32, y: u32) -> u32 {
    let s = seed(2);
    finish(s.wrapping_add(x), s.wrapping_add(y), s)
}

/// Hashes three words.
#[inline(always)]
pub fn hash3(x: u32, y: u32, z: u32) -> u32 {
    let s = seed(3);
    finish(s.wrapping_add(x), s.wrapping_add(y), s.wrapping_add(z))
}

/// Hashes four words.
#[inline(always)]
pub fn hash4(x: u32, y: u32, z: u32, w: u32) -> u32 {
    let s = seed(4);
    let (a, b, c) = mix(s.wrapping_add(x), s.wrapping_add(y), s.wrapping_add(z));
    finish(a.wrapping_add(w), b, c)
}

/// Hashes five words.
#[inline(always)]
pub fn hash5(x: u32, y: u32, z: u32, w: u32, v: u32) -> u32 {
    let s = seed(5);
    let (a, b, c) = mix(s.wrapping_add(x), s.wrapping_add(y), s.wrapping_add(z));
    finish(a.wrapping_add(w), b.wrapping_add(v), c)
}

/// Maps a hash to [0, 1]. The upper end is reached, as the greatest words round up to 2^32.
#[inline(always)]
pub fn to_unit(bits: u32) -> f32 {
    // OSL divides by 2^32 - 1, whose reciprocal rounds to 2^-32 in f32.
    bits as f32 * (1.0 / 4_294_967_296.0)
}
