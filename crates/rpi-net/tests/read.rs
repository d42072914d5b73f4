//! Every recorded net is parsed, its size matches the recorded table, and no damaged text makes the parser panic.

mod nets;

use rpi_diag::{Code, FileId, Severity};
use rpi_net::rpinet::{NetSize, count_text, parse};

#[test]
fn every_recorded_net_is_read() {
    let Some(all) = nets::all() else { return };
    let mut refused = Vec::new();
    for (name, text) in &all {
        let (net, mut diagnostics) = parse(name, FileId(0), text);
        if name == "corpus/nets/synth-0146" {
            let ignored = diagnostics.pop().map(|f| f.message);
            let expected = "`Core::IntArrayIsNull` has no in-port `inNull`";
            assert_eq!(ignored.as_deref(), Some(expected));
        }
        if net.is_none() || !diagnostics.is_empty() {
            let messages: Vec<String> = diagnostics.iter().map(|f| f.message.clone()).collect();
            refused.push(format!("{name}: {}", messages.join("; ")));
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

/// Recorded size of a net from the tables beside the nets: the row of the `opt` phase, by file name.
fn recorded_size(file: &str) -> Option<NetSize> {
    let (table, id) = match file.split_once('/')? {
        ("v1", name) => match name.split_once('-')? {
            ("main", rest) => ("v1-sizes.tsv", rest),
            (_, rest) => ("v1-sequence-sizes.tsv", rest),
        },
        (_, name) => ("v2-sizes.tsv", name),
    };
    let id: usize = id.split('-').next()?.parse().ok()?;
    let text =
        rpi_testkit::read_maybe_gz(rpi_testkit::external_data_path("nets")?.join(table)).ok()?;
    let row = text.lines().map(|l| l.split('\t').collect::<Vec<_>>());
    let row = row
        .into_iter()
        .rfind(|r| r[0].parse() == Ok(id) && r[1] == "opt")?;
    let count = |k: usize| row[k].parse().expect("a count");
    Some(NetSize {
        primitives: count(3),
        fragments: count(4),
        gated: count(5),
        depth: count(6),
        links: count(7),
        bytes: count(8),
        types: count(9),
    })
}

#[test]
fn sizes_are_those_of_the_tables() {
    let Some(all) = nets::all() else { return };
    let mut compared = 0;
    for (name, text) in all.iter().filter(|(n, _)| n.starts_with('v')) {
        let recorded = recorded_size(name).expect("each of these nets has a row");
        assert_eq!(count_text(text), recorded, "{name}");
        let size = NetSize::from_net(&nets::net(name, text));
        assert_eq!(
            (size.fragments, size.gated, size.depth, size.types),
            (
                recorded.fragments,
                recorded.gated,
                recorded.depth,
                recorded.types
            ),
            "{name}"
        );
        assert!(size.primitives <= recorded.primitives, "{name}");
        compared += 1;
    }
    assert_eq!(compared, 59);
}

#[test]
fn what_the_reference_writes_twice_counts_once() {
    let Some(all) = nets::all() else { return };
    let (name, text) = all
        .iter()
        .find(|(n, _)| n == "v1/main-004-opt-lin")
        .expect("the net is there");
    assert_eq!(count_text(text).primitives, 1454);
    assert_eq!(
        NetSize::from_net(&nets::net(name, text)).primitives,
        1454 - 172
    );
}

/// Pseudo-random number generator (xorshift64, Marsaglia 2003) with a fixed seed, so that the damage is reproducible.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

/// Text with a few characters deleted, duplicated or replaced.
fn damaged(text: &str, random: &mut Random) -> String {
    const SIGNS: &[u8] = b"{}()[],.='\\:a0_ \n\xc3\xa9";
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        let end = (at + random.below(20)).min(bytes.len());
        match random.below(3) {
            0 => drop(bytes.drain(at..end)),
            1 => bytes.insert(at, SIGNS[random.below(SIGNS.len())]),
            _ => bytes[at] = SIGNS[random.below(SIGNS.len())],
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Parses a text that may be damaged: the net is `Some` exactly if there is no error, and every diagnostic is inside
/// the text.
fn survive(text: &str) {
    let (net, diagnostics) = parse("broken", FileId(0), text);
    let errors = diagnostics
        .iter()
        .filter(|f| f.severity() == Severity::Error);
    assert_eq!(net.is_none(), errors.count() > 0, "{text}");
    for label in diagnostics.iter().flat_map(|f| &f.labels) {
        let (start, end) = (label.span.start as usize, label.span.end as usize);
        assert!(text.get(start..end).is_some(), "{start}..{end} in {text}");
    }
}

#[test]
fn no_cut_or_damaged_net_makes_it_panic() {
    let Some(all) = nets::all() else { return };
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    for (_, text) in &all {
        let rounds = (400_000 / text.len()).clamp(1, 60);
        for _ in 0..rounds {
            survive(&text[..random.below(text.len())]);
            survive(&damaged(text, &mut random));
        }
    }
}

#[test]
fn every_prefix_of_a_small_net_is_survived() {
    let text = "{a=Core::DoubleAdd(inFirst[0.5]=Core::Clock(Increment='1.0').outValue,Second='2.0'),é\
        f={k=Core::BooleanNetcommOut(inValue=parent.i1,Key='it\\'s \\\\ it's'),o1=parent.i1,b=k}(inActive=g.outValue,i1=g.outValue),\
        g=Core::DoubleGreater(inFirst=a.outValue),outX=f.o1,outTerminate=g.outValue}";
    for end in (0..=text.len()).filter(|&k| text.is_char_boundary(k)) {
        survive(&text[..end]);
        survive(&text[end..]);
    }
}

#[test]
fn deep_nesting_is_refused() {
    for text in [
        "{a=".repeat(100_000),
        "{a=A(b=".repeat(100_000),
        "(".repeat(100_000),
    ] {
        let (net, diagnostics) = parse("deep", FileId(0), &text);
        assert!(net.is_none());
        assert!(diagnostics.len() < 10, "{}", diagnostics.len());
    }
    let (_, diagnostics) = parse("deep", FileId(0), &"{a=".repeat(1000));
    assert!(diagnostics.iter().any(|f| f.code == Code::RPI0103));
}

/// Checks the nets on the pages of the diagnostic codes.
#[test]
fn pages_show_what_they_say() {
    let mut checked = 0;
    for code in Code::ALL {
        for (info, program) in fences(code.page()) {
            let (net, diagnostics) = parse("page", FileId(0), &program);
            let codes: Vec<Code> = diagnostics.iter().map(|f| f.code).collect();
            match info.as_str() {
                "rpi-wrong net" => assert_eq!(codes, [*code], "{program}"),
                "rpi-right net" => assert!(net.is_some() && codes.is_empty(), "{code}: {codes:?}"),
                _ => continue,
            }
            checked += 1;
        }
    }
    assert!(checked >= 30, "{checked}");
}

/// Info string and content of the fenced blocks of a page.
fn fences(page: &str) -> Vec<(String, String)> {
    let blocks = page.split("```").skip(1).step_by(2);
    let parts = blocks.filter_map(|b| b.split_once('\n'));
    parts
        .map(|(info, text)| (info.to_owned(), text.to_owned()))
        .collect()
}
