//! The parser that lalrpop makes of `grammar/rpi.lalrpop`.

#[allow(
    clippy::all,
    missing_docs,
    unreachable_pub,
    unused,
    reason = "generated code"
)]
mod generated {
    lalrpop_util::lalrpop_mod!(pub rpi);
}

pub(crate) use generated::rpi::ItemParser;
