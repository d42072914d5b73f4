//! Entry points for messages of clients of the server, and for compressed files.

use rpi_serve::methods;
use rpi_testkit::files_below;

use crate::seeds::Seed;

/// Maximum size in bytes of a decompressed file (32 MiB): a compressed file of a few bytes can hold more.
const MAX_FILE: u64 = 32 << 20;

/// Entry point of the fuzzer for compressed files: decompresses a file within its limit.
pub(crate) fn decompress(input: &[u8]) {
    if let Ok(content) = rpi_files::decompress(input.to_vec(), MAX_FILE) {
        assert!(content.len() as u64 <= MAX_FILE.max(input.len() as u64));
    }
}

/// Returns the initial corpus for requests over HTTP: those of the tests of the server.
pub(crate) fn requests() -> Vec<Seed> {
    let files = files_below("crates/rpi-serve/tests/http", &[".txt"]);
    let seed = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).ok()?;
        let (_, request) = text.split_once("\n\n")?;
        let lines = request.lines().filter(|line| !line.starts_with('@'));
        let request: String = lines.collect();
        Some(Seed {
            name: path.file_stem()?.to_string_lossy().into_owned(),
            bytes: request
                .replace("\\r", "\r")
                .replace("\\n", "\n")
                .into_bytes(),
        })
    };
    files.iter().filter_map(seed).collect()
}

/// Returns the initial corpus for lines: a request of each method, batches, and lines that are no requests.
pub(crate) fn lines() -> Vec<Seed> {
    let one = |method: &str, params: &[&str]| {
        let given = params
            .iter()
            .map(|param| format!("\"{param}\":{}", value(param)));
        let given = given.collect::<Vec<_>>().join(",");
        format!("{{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"{method}\",\"params\":{{{given}}}}}")
    };
    let requests: Vec<(&str, String)> = methods().map(|(name, p)| (name, one(name, p))).collect();
    let batch: Vec<&str> = requests.iter().map(|(_, text)| text.as_str()).collect();
    let all = format!("[{}]\n", batch.join(","));
    let others = [
        ("batch", all),
        (
            "two-lines",
            format!("{}\n\n {} \r\n{{\"id\":", batch[0], batch[1]),
        ),
        (
            "no-request",
            "[1,[],{\"id\":{}},null,\"\\u0000\",1e999]\n".to_owned(),
        ),
    ];
    let single = requests
        .iter()
        .map(|(name, text)| (*name, format!("{text}\n")));
    let seed = |(name, text): (&str, String)| Seed {
        name: name.to_owned(),
        bytes: text.into_bytes(),
    };
    single.chain(others).map(seed).collect()
}

/// Returns a value for a parameter of JSON-RPC, as JSON.
fn value(param: &str) -> &'static str {
    match param {
        "period" | "grace" | "override" => "0.5",
        "shared" | "keep" | "paused" => "true",
        "stop" | "cancel" | "start" => "[\"n1\"]",
        "values" | "parameters" => "{\"gain\":\"0.5\"}",
        "when" => "\"n1.done & !n2@error(3) | t\"",
        _ => "\"n1\"",
    }
}

/// Returns the initial corpus for websockets: frames with the requests, whole, masked, in fragments, and control frames.
pub(crate) fn frames() -> Vec<Seed> {
    let requests = lines();
    let mut seeds: Vec<Seed> = requests.iter().map(framed).collect();
    let others: [(&str, &[u8]); 5] = [
        ("masked", b"\x81\x82\x01\x02\x03\x04\x7a\x7f"),
        ("fragments", b"\x01\x01{\x89\x02hi\x00\x00\x80\x01}"),
        ("close", b"\x88\x05\x03\xe8bye"),
        ("binary", b"\x82\x01x"),
        ("huge", b"\x81\x7f\x00\x00\x00\x00\x40\x00\x00\x00x"),
    ];
    seeds.extend(others.map(|(name, bytes)| Seed {
        name: name.to_owned(),
        bytes: bytes.to_vec(),
    }));
    seeds
}

/// Returns a text frame with a message (RFC 6455, section 5.2).
fn framed(seed: &Seed) -> Seed {
    let length = seed.bytes.len() as u16;
    let mut bytes = match length {
        0..126 => vec![0x81, length as u8],
        _ => [&[0x81, 126], &length.to_be_bytes()[..]].concat(),
    };
    bytes.extend(&seed.bytes);
    Seed {
        name: seed.name.clone(),
        bytes,
    }
}

/// Returns the initial corpus for DirectIO: the messages of the recorded exchanges.
pub(crate) fn messages() -> Vec<Seed> {
    let files = files_below("crates/rpi-serve/tests/exchanges", &[".txt"]);
    let texts = files
        .iter()
        .filter_map(|path| std::fs::read_to_string(path).ok());
    let lines: Vec<String> = texts
        .flat_map(|text| text.lines().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    let sent = lines.iter().filter_map(|line| line.split_once("> "));
    let seed = |(number, (_, message)): (usize, (&str, &str))| Seed {
        name: format!("message-{number}"),
        bytes: message.replace('$', "n").into_bytes(),
    };
    sent.enumerate().map(seed).collect()
}

/// Returns the initial corpus for compressed files: small files, a file of several parts, and one that decompresses to
/// far more than its own size.
pub(crate) fn compressed() -> Vec<Seed> {
    let texts = crate::seeds::texts();
    let small = texts.iter().take(16);
    let pack = |name: &str, bytes: &[u8]| Seed {
        name: format!("{name}.gz"),
        bytes: rpi_testkit::gzip(bytes),
    };
    let mut seeds: Vec<Seed> = small.map(|seed| pack(&seed.name, &seed.bytes)).collect();
    let bomb = pack("zeros", &vec![0; MAX_FILE as usize + 1]);
    let parts = seeds.iter().take(3).flat_map(|seed| seed.bytes.clone());
    seeds.push(Seed {
        name: "parts.gz".to_owned(),
        bytes: parts.collect(),
    });
    seeds.push(bomb);
    seeds
}
