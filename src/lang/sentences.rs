//! What every function and global of the language means, in one sentence each.

/// The sentences, sorted by name.
const SENTENCES: &[(&str, &str)] = &[
    ("Ci", "The closure that a surface or volume shader computes."),
    ("Dx", "The change of a value from this pixel to the next one to the right."),
    ("Dy", "The change of a value from this pixel to the next one below."),
    ("Dz", "The change of a value along the third axis of a volume; 0 on surfaces."),
    ("I", "The direction of view, from the eye to the point that is shaded."),
    ("N", "The shading normal, of unit length and smooth over the faces of a mesh."),
    ("Ng", "The true normal of the surface, of unit length."),
    ("P", "The point that is shaded, in common space."),
    ("Ps", "The point whose light is computed; the same as `P` in a surface shader."),
    ("aastep", "0 below the edge and 1 above it, averaged over the width of the filter."),
    ("abs", "The absolute value, component by component."),
    ("acos", "The angle in 0..pi whose cosine is x; x is clamped to -1..1."),
    ("area", "The area of the surface that a pixel covers, from the derivatives of a point."),
    ("arraylength", "How many elements an array has."),
    (
        "artistic_ior",
        "The complex index of refraction of a metal from its colour seen straight on and at grazing angles.",
    ),
    ("asin", "The angle in -pi/2..pi/2 whose sine is x; x is clamped to -1..1."),
    ("atan", "The angle in -pi/2..pi/2 whose tangent is x."),
    ("atan2", "The angle in -pi..pi of the direction with the coordinates y and x."),
    ("backfacing", "1 where the surface is seen from behind, else 0."),
    ("blackbody", "The colour of a glowing black body of a temperature in kelvin, as radiance."),
    (
        "bump",
        "Moves the shading point by an amount along the normal for the new normal's sake; the point itself goes back.",
    ),
    ("calculatenormal", "The unit normal of the surface that a point makes as it varies, from its derivatives."),
    ("cbrt", "The cube root."),
    ("ceil", "The least whole number that is not below x."),
    ("cellnoise", "A random value in 0..1 that is constant in each cell between whole coordinates."),
    ("clamp", "x limited to the interval from low to high."),
    ("concat", "The strings one after the other."),
    ("cos", "The cosine of an angle in radians."),
    ("cosh", "The hyperbolic cosine."),
    ("cross", "The cross product: a vector at right angles to both, as long as the area between them."),
    ("dPdtime", "How fast the point moves, per unit of time."),
    ("dPdu", "The derivative of `P` along `u`: a tangent of the surface."),
    ("dPdv", "The derivative of `P` along `v`: a tangent of the surface."),
    ("degrees", "An angle in degrees from one in radians."),
    ("determinant", "The determinant of a matrix."),
    (
        "dict_find",
        "The first node of a dictionary (JSON or XML text, or a file) that a query finds; 0 when there is none, -1 when the dictionary is wrong.",
    ),
    ("dict_next", "The node that the same query finds after this one; 0 when there is none."),
    ("dict_value", "Reads an attribute of a node into a variable; 1 when that worked, else 0."),
    ("displace", "Moves the shading point along the normal by an amount, or by a vector, and makes the normal anew."),
    ("distance", "The distance between two points, or of a point from a segment."),
    ("dot", "The dot product."),
    ("dtime", "How long the shutter is open."),
    ("endswith", "1 when a string ends with another one, else 0."),
    ("environment", "Looks up a picture of all directions; options follow as pairs of a name and a value."),
    ("erf", "The error function."),
    ("erfc", "One less the error function, exact where that is small."),
    ("error", "Prints a message as an error, formatted as by `printf`."),
    ("exit", "Ends the shader here; what it has computed holds."),
    ("exp", "e to the power of x."),
    ("exp2", "2 to the power of x."),
    ("expm1", "e to the power of x, less 1, exact where x is small."),
    ("fabs", "The absolute value, component by component."),
    ("faceforward", "N, turned to the side that the direction I comes from."),
    ("filterwidth", "How far a value changes over a pixel: the width that a filter of it should have."),
    ("floor", "The greatest whole number that is not above x."),
    ("fmod", "The remainder of a / b with the sign of a; 0 when b is 0."),
    ("format", "The string that `printf` would print."),
    ("fprintf", "Appends formatted text to a file."),
    ("fresnel", "How much light a smooth boundary reflects and lets through, and in which directions."),
    (
        "getattribute",
        "Reads an attribute of the object, or of the renderer, into a variable; 1 when there is one of this name and type.",
    ),
    ("getchar", "The code of a character of a string, by its index; 0 outside."),
    ("getmatrix", "Reads the matrix from one space to another into a variable; 1 when both spaces are known."),
    (
        "getmessage",
        "Reads what an earlier layer, or the last `trace`, has left under a name; 1 when there was something of this type.",
    ),
    (
        "gettextureinfo",
        "Reads what is known of a texture (\"resolution\", \"channels\", …) into a variable; 1 when it is known.",
    ),
    ("hash", "A whole number that looks random and is always the same for the same arguments."),
    ("hashnoise", "A random value in 0..1 that is another one for every different coordinate."),
    ("hypot", "The root of the sum of the squares: the length of a hypotenuse."),
    ("inversesqrt", "1 over the square root; 0 where x is not above 0."),
    ("iscameraray", "1 where the camera sees the point, else 0."),
    (
        "isconnected",
        "1 when a parameter is connected to an earlier layer (2 when a later one reads it, 3 for both), else 0.",
    ),
    ("isconstant", "1 when the compiler knows the value, else 0."),
    ("isdiffuseray", "1 where the point is reached by a diffuse bounce, else 0."),
    ("isfinite", "1 for a number that is neither infinite nor undefined, else 0."),
    ("isglossyray", "1 where the point is reached by a glossy bounce, else 0."),
    ("isinf", "1 for an infinite number, else 0."),
    ("isnan", "1 for what is not a number, else 0."),
    ("isshadowray", "1 where a shadow ray asks for the point, else 0."),
    ("length", "The length of a vector."),
    ("linearstep", "A straight ramp from 0 at the first edge to 1 at the second."),
    ("log", "The natural logarithm, or that to a base."),
    ("log10", "The logarithm to the base 10."),
    ("log2", "The logarithm to the base 2."),
    ("logb", "The exponent of x as a power of 2, as a whole number."),
    ("luminance", "The brightness of a linear colour, as the eye weighs its components."),
    ("max", "The greater of two values, component by component."),
    ("min", "The lesser of two values, component by component."),
    ("mix", "The blend of two values: x where a is 0 and y where it is 1."),
    ("mod", "The remainder of a / b: with the sign of b for floats, with that of a for integers."),
    (
        "noise",
        "Perlin noise in 0..1, or the noise of the name that goes first; options follow as pairs of a name and a value.",
    ),
    ("normalize", "A vector of the same direction and length 1; 0 stays 0."),
    ("pnoise", "Noise that repeats with a period."),
    ("pointcloud_get", "Reads an attribute of the points that a search has found into an array."),
    (
        "pointcloud_search",
        "Finds the points of a point cloud around a position, and says how many there are; velour has none.",
    ),
    ("pointcloud_write", "Adds a point to a point cloud; velour writes none."),
    ("pow", "x to the power of y; 0 where that would be no number."),
    ("printf", "Prints text; `%d`, `%f`, `%s` and so on stand for the values that follow."),
    ("psnoise", "Noise in -1..1 that repeats with a period."),
    ("radians", "An angle in radians from one in degrees."),
    ("random", "A random value in 0..1 that differs from sample to sample."),
    ("raytype", "1 where the point is reached by a ray of this kind (\"camera\", \"shadow\", \"diffuse\", …), else 0."),
    ("reflect", "The mirror direction of I about N."),
    (
        "refract",
        "The direction of I behind a boundary, by Snell's law; 0 on total reflection. eta is the index outside over that inside.",
    ),
    ("regex_match", "1 when a whole string matches a regular expression; its groups go to an array."),
    ("regex_search", "1 when a part of a string matches a regular expression; its groups go to an array."),
    ("rotate", "A point turned by an angle in radians about an axis."),
    ("round", "The nearest whole number; halves go away from 0."),
    ("select", "The first value where the condition is 0, else the second, component by component."),
    ("setmessage", "Leaves a value under a name for later layers."),
    ("sign", "-1, 0 or 1, as x is below, at or above 0."),
    ("sin", "The sine of an angle in radians."),
    ("sincos", "Sine and cosine of an angle, in one call."),
    ("sinh", "The hyperbolic sine."),
    ("smooth_linearstep", "A straight ramp from 0 to 1 whose corners are rounded over a width."),
    ("smoothstep", "A smooth ramp from 0 at the first edge to 1 at the second, flat at both ends."),
    ("snoise", "Perlin noise in -1..1."),
    ("spline", "A curve through knots of equal distance, at x in 0..1; the name says which kind of curve."),
    ("splineinverse", "The x at which a spline has a value."),
    ("split", "Cuts a string at separators into an array, and says how many parts there are."),
    ("sqrt", "The square root; 0 where x is below 0."),
    ("startswith", "1 when a string begins with another one, else 0."),
    ("step", "0 where x is below the edge, else 1."),
    ("stof", "The number that a string begins with, as a float."),
    ("stoi", "The number that a string begins with, as an int."),
    ("strlen", "How many characters a string has."),
    ("substr", "The part of a string from an index on, of a length; a negative index counts from the end."),
    ("surfacearea", "The area of the object that is shaded."),
    ("tan", "The tangent of an angle in radians."),
    ("tanh", "The hyperbolic tangent."),
    ("texture", "Looks up a picture at two coordinates; options follow as pairs of a name and a value."),
    ("texture3d", "Looks up a volume at a point; velour has none and gives what is missing."),
    ("time", "The time of the sample."),
    ("trace", "1 when a ray from a point in a direction meets something, else 0."),
    ("transform", "A point, vector or normal in another space, by a matrix or by the names of the spaces."),
    ("transformc", "A colour in another colour space."),
    ("transformu", "A number in another unit of length or time."),
    ("transpose", "The transposed matrix."),
    ("trunc", "The whole part of x, towards 0."),
    ("u", "The first coordinate on the surface."),
    ("v", "The second coordinate on the surface."),
    ("warning", "Prints a message as a warning, formatted as by `printf`."),
    ("wavelength_color", "The colour of light of a wavelength in nanometres."),
];

/// What a function or global means; nothing for another name, and for closures, whose definitions say it.
pub fn sentence(name: &str) -> Option<&'static str> {
    let at = SENTENCES.binary_search_by(|(known, _)| known.cmp(&name)).ok()?;
    Some(SENTENCES[at].1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{builtins, globals::GLOBALS};

    #[test]
    fn everything_built_in_has_its_sentence() {
        assert!(SENTENCES.is_sorted_by(|a, b| a.0 < b.0));
        let missing: Vec<&str> = builtins::names()
            .chain(GLOBALS.iter().map(|global| global.0))
            .filter(|name| sentence(name).is_none())
            .collect();
        assert!(missing.is_empty(), "{missing:?}");
        for (name, text) in SENTENCES {
            assert!(text.ends_with('.') && text.len() > 8, "{name}");
        }
    }
}
