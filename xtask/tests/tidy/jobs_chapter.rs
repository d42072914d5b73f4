//! The chapter for programmers of other robot languages shows the programs of `examples/jobs` as they are, and counts the lines
//! of both sides truly.

use rpi_testkit::workspace_root;
use xtask::{Fence, fences};

const CHAPTER: &str = "docs/src/coming-from.md";

/// Number of lines below which each job stays.
const MOST_LINES: usize = 25;

/// Other languages whose programs are counted: marker of the fence, name, beginning of a comment.
const OTHERS: &[(&str, &str, &str)] = &[("krl", "KRL", ";"), ("rapid", "RAPID", "!")];

/// A job of the chapter: its program, and the first program in another language after it.
struct Job {
    name: String,
    own: Fence,
    other: Fence,
}

fn read(path: &str) -> String {
    std::fs::read_to_string(workspace_root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Counts the lines of a program without blank lines and lines with a comment only.
fn count(code: &str, comment: &str) -> usize {
    let lines = code.lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with(comment))
        .count()
}

/// Returns the name of the job whose program a fence shows: `rpi NAME.rpi`.
fn job_name(fence: &Fence) -> Option<String> {
    let file = fence.info.split_once(' ')?.1;
    file.strip_suffix(".rpi").map(str::to_owned)
}

fn jobs() -> Vec<Job> {
    let mut jobs = Vec::new();
    let mut program: Option<(String, Fence)> = None;
    for fence in fences(&read(CHAPTER)) {
        if let Some(name) = job_name(&fence) {
            assert!(program.is_none(), "no other language after {name}");
            program = Some((name, fence));
        } else if OTHERS.iter().any(|other| other.0 == fence.info)
            && let Some((name, own)) = program.take()
        {
            let other = fence;
            jobs.push(Job { name, own, other });
        }
    }
    assert!(program.is_none(), "no other language after the last job");
    jobs
}

#[test]
fn every_job_is_in_the_chapter_as_it_is() {
    let folders = std::fs::read_dir(workspace_root().join("examples/jobs")).expect("the jobs");
    let mut examples: Vec<String> = folders
        .map(|folder| {
            folder
                .expect("a folder")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    let jobs = jobs();
    let mut shown: Vec<String> = jobs.iter().map(|job| job.name.clone()).collect();
    examples.sort();
    shown.sort();
    assert_eq!(shown, examples);
    for Job { name, own, .. } in jobs {
        let file = read(&format!("examples/jobs/{name}/{name}.rpi"));
        assert_eq!(
            own.code.trim(),
            file.trim(),
            "{CHAPTER} shows another {name}.rpi"
        );
    }
}

#[test]
fn the_table_counts_the_lines() {
    let chapter = read(CHAPTER);
    for Job { name, own, other } in jobs() {
        let (_, language, comment) = *OTHERS
            .iter()
            .find(|(info, ..)| *info == other.info)
            .expect("one of the other languages");
        let (ours, theirs) = (count(&own.code, "--"), count(&other.code, comment));
        let row = format!("| {language} | {theirs} | {ours} |");
        assert!(ours < MOST_LINES, "{name} has {ours} lines");
        assert!(
            ours <= theirs,
            "{name} has {ours} lines, {language} {theirs}"
        );
        let title = heading_of(&chapter, &own).expect("a heading");
        let start = format!("| [{title}](");
        let line = chapter.lines().find(|line| line.starts_with(&start));
        let line = line.unwrap_or_else(|| panic!("the table has no row of {title}"));
        assert!(line.ends_with(&row), "{title}: {row}");
    }
}

/// Returns the heading of the section in which a fence is.
fn heading_of<'a>(chapter: &'a str, fence: &Fence) -> Option<&'a str> {
    let before = chapter.lines().take(fence.line);
    before.filter_map(|line| line.strip_prefix("## ")).last()
}
