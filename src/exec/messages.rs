//! Messages: values that shaders of one point leave for each other by name.
//!
//! As in OSL, a message is written once and not after it was asked for, and is read as what it was written as; anything else is
//! reported and has no effect.

use super::lane::Lane;
use super::report::{MessageFault, Mistake};
use super::run::Run;
use super::slots::{Slot, State};
use crate::ir::op::MessageShape;
use crate::ir::program::{Kind, Reg};
use crate::lang::symbols::Symbol;
use crate::limits::{LEFT_MESSAGES, LEFT_NUMBERS};
use velour_grammar::Span;

impl Run<'_> {
    /// The message of a name that a lane has set or asked for.
    fn message_of(&self, name: i32, lane: usize) -> Option<usize> {
        self.s.messages.iter().position(|slot| slot.name == name && slot.states[lane] != State::Nothing)
    }

    /// The place for messages of a name and type, a new one where there is none.
    fn slot_for(&mut self, name: i32, shape: &MessageShape) -> Option<usize> {
        let known = self.s.messages.iter().position(|slot| slot.name == name && slot.shape.as_ref() == Some(shape));
        let numbers = |slot: &Slot| slot.shape.as_ref().map_or(0, |shape| shape.count);
        let held: u32 = self.s.messages.iter().map(numbers).fold(shape.count, u32::saturating_add);
        if known.is_none() && self.s.messages.len() < LEFT_MESSAGES && held <= LEFT_NUMBERS {
            self.s.messages.push(Slot::new(name, shape, self.n));
            return Some(self.s.messages.len() - 1);
        }
        known
    }

    fn reject(&mut self, lane: usize, span: Span, fault: MessageFault, slot: usize) {
        let first = Box::new((self.group.locate)(self.s.messages[slot].spans[lane]));
        let name = self.tree.strings.text(Symbol(self.s.messages[slot].name)).to_owned();
        let text = format!("{} in {first}", fault.text(&name));
        self.report_once(lane, span, Mistake::Message { name, fault, first }, text);
    }

    pub(super) fn set_message(&mut self, shape: &MessageShape, src: &[Reg], span: Span) {
        let mut closures = None;
        for lane in 0..self.n {
            if self.idle(lane, self.n) || self.s.mask[lane] == 0 {
                continue;
            }
            let name = Lane { run: self, src, lane }.i(0);
            if let Some(known) = self.message_of(name, lane) {
                let asked = self.s.messages[known].states[lane] == State::Asked;
                let fault = if asked { MessageFault::AskedBefore } else { MessageFault::Twice };
                self.reject(lane, span, fault, known);
                continue;
            }
            let Some(at) = self.slot_for(name, shape) else {
                return self.fatal(span, "a batch has more than 1,024 messages of different names or types, or more than 65,536 numbers in them");
            };
            for (number, &reg) in src[1..].iter().enumerate() {
                let (slot, regs) = (&mut self.s.messages[at], &*self.regs);
                let pick = |len: usize| if len == 1 { 0 } else { lane };
                match shape.kind {
                    Kind::Float => slot.floats[number][lane] = regs.f(reg)[pick(regs.f(reg).len())],
                    Kind::Int | Kind::String => slot.ints[number][lane] = regs.i(reg)[pick(regs.i(reg).len())],
                    Kind::Closure => closures = Some(at),
                }
            }
            let slot = &mut self.s.messages[at];
            (slot.states[lane], slot.spans[lane]) = (State::Set, span);
        }
        if let Some(at) = closures {
            self.set_closures(at, &src[1..], span);
        }
    }

    /// Closures are of the whole batch: each message's is chosen by the lanes that have set it here.
    fn set_closures(&mut self, at: usize, src: &[Reg], span: Span) {
        let slot = &self.s.messages[at];
        let here = |lane: usize| slot.states[lane] == State::Set && slot.spans[lane] == span;
        let mask: Vec<i32> = (0..self.n).map(|lane| i32::from(here(lane))).collect();
        for (number, &reg) in src.iter().enumerate() {
            let (new, old) = (self.closure(reg), self.s.messages[at].closures[number]);
            self.s.messages[at].closures[number] = self.choose_closure(&mask, new, old);
        }
    }

    pub(super) fn get_message(&mut self, shape: &MessageShape, dst: &[Reg], src: &[Reg], span: Span) {
        self.regs.ints[dst[0].0 as usize].fill(0);
        let mut from = None;
        for lane in 0..self.n {
            if self.idle(lane, self.n) || self.s.mask[lane] == 0 {
                continue;
            }
            let name = Lane { run: self, src, lane }.i(0);
            let Some(known) = self.message_of(name, lane) else {
                if let Some(at) = self.slot_for(name, shape) {
                    let slot = &mut self.s.messages[at];
                    (slot.states[lane], slot.spans[lane]) = (State::Asked, span);
                }
                continue;
            };
            let slot = &self.s.messages[known];
            if slot.shape.as_ref() != Some(shape) {
                let created = slot.shape.as_ref().map_or(String::new(), |shape| shape.ty.clone());
                let fault = MessageFault::Type { created, wanted: shape.ty.clone() };
                self.reject(lane, span, fault, known);
                continue;
            }
            if slot.states[lane] == State::Asked {
                continue;
            }
            for (number, reg) in dst[1..].iter().enumerate() {
                let slot = &self.s.messages[known];
                match shape.kind {
                    Kind::Float => self.regs.floats[reg.0 as usize][lane] = slot.floats[number][lane],
                    Kind::Int | Kind::String => self.regs.ints[reg.0 as usize][lane] = slot.ints[number][lane],
                    Kind::Closure => from = Some(known),
                }
            }
            self.regs.ints[dst[0].0 as usize][lane] = 1;
        }
        if let Some(known) = from {
            for (number, reg) in dst[1..].iter().enumerate() {
                self.regs.closures[reg.0 as usize] = self.s.messages[known].closures[number];
            }
        }
    }
}
