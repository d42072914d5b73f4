//! Rules of `ARCHITECTURE.md` as tests, one file per rule or kind of rule.

mod banned_terms;
mod book;
mod checklist;
mod codes;
mod compile;
mod crate_graph;
mod cycle;
mod docs;
mod file_reads;
mod first_mistakes;
mod fixes;
mod forbidden_text;
mod generated;
mod guides;
mod jobs_chapter;
mod links;
mod owners;
mod primitives;
mod rules;
mod semantics;
mod sizes;
mod ui;
mod unsafety;
