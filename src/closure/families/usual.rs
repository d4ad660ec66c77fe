//! Parameters that many closures have.

use crate::lang::closures::ParamSpec;

/// The shading normal.
pub(super) const NORMAL: ParamSpec = ParamSpec::about("shading normal, unit length");

/// The direction that a width along it belongs to.
pub(super) const TANGENT: ParamSpec = ParamSpec::about("direction of xalpha; zero for any");
