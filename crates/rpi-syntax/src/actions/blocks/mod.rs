//! Actions of the grammar for the blocks of equations of Kind 2 (`if`, `when`, `cond`, `frame`), and their desugaring.
//!
//! A block becomes one equation per flow, with the conditions in its value.

mod definitions;
mod desugar;
mod frame_arrays;
mod frame_init;

use self::desugar::Desugarer;
use crate::ast::*;
use crate::context::ParseContext;

pub(crate) fn choice(
    cx: &ParseContext<'_>,
    word: ConditionalKeyword,
    first: BlockBranch,
    rest: Vec<BlockBranch>,
    otherwise: Option<Vec<Statement>>,
) -> Box<ConditionalBlock> {
    let branches = crate::actions::with_elements(vec![first], rest);
    let mut choice = Box::new(ConditionalBlock {
        keyword: word,
        branches,
        else_statements: otherwise,
        desugared: Desugared::default(),
    });
    choice.desugared = Desugarer::new(cx, &[]).desugar_choice(&choice);
    choice
}

pub(crate) fn frame_block(
    cx: &ParseContext<'_>,
    names: Vec<Ident>,
    initial: Vec<Statement>,
    statements: Vec<Statement>,
) -> Box<FrameBlock> {
    let mut keep = Box::new(FrameBlock {
        names,
        initial,
        statements,
        desugared: Desugared::default(),
    });
    keep.desugared = Desugarer::new(cx, &keep.names).desugar_frame(&keep);
    keep
}
