//! stub
use lalrpop_util::{ErrorRecovery, ParseError};
use crate::token::Token;

pub type Recovery<'s> = ErrorRecovery<u32, Token<'s>, ()>;
pub struct Failure { }
impl From<Recovery<'_>> for Failure { fn from(_: Recovery<'_>) -> Self { Failure {} } }
