//! Replays of small nets against small traces: detected differences and the report.

use rpi_diag::FileId;
use rpi_net::Net;
use rpi_record::trace::Trace;
use rpi_replay::trace_compare::{CompareReport, Options, ReplayError, replay};

/// Test net: x counts up by the value of an input; y doubles x; f holds a constant while the input is positive.
const NET: &str = "{k=Core::DoubleNetcommIn(Key='k',Value='1.0'),x=Core::Clock(inIncrement=k.outValue),\
    y=Core::DoubleAdd(inFirst=x.outValue,inSecond=x.outValue),p=Core::DoublePre(inValue=y.outValue),\
    on=Core::DoubleGreater(inFirst=k.outValue,Second='0'),\
    f={c=Core::DoubleValue(Value='5.0'),outC=c.outValue}(inActive=on.outValue)}";

fn net(text: &str) -> Net {
    let (net, diagnostics) = rpi_net::rpinet::parse("small", FileId(0), text);
    net.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

fn run(rows: &str) -> Result<CompareReport, ReplayError> {
    let text = format!("0\t#t0\t1000\tcycle=1\n{}", rows.replace(' ', "\t"));
    let options = Options {
        period_ns: 500_000_000,
        ..Options::default()
    };
    replay(&net(NET), &Trace::parse(&text).unwrap(), &options)
}

/// Returns one cycle of a trace that agrees with the net.
fn cycle(n: u32, k: f64, x: f64, before: Option<f64>) -> String {
    let on = k > 0.0;
    let mut rows = format!(
        "{n} k.outValue {k:?}\n{n} x.outValue {x:?}\n{n} y.outValue {:?}\n{n} on.outValue {on}\n",
        2.0 * x
    );
    if let Some(before) = before {
        rows += &format!("{n} p.outValue {before:?}\n");
    }
    if on {
        rows += &format!("{n} f/c.outValue 5.0\n{n} f.outC 5.0\n");
    }
    rows
}

fn good() -> [String; 3] {
    [
        cycle(1, 1.0, 0.5, None),
        cycle(2, 3.0, 2.0, Some(1.0)),
        cycle(3, -1.0, 1.5, Some(4.0)),
    ]
}

#[test]
fn a_true_trace_agrees_and_everything_is_counted() {
    let report = run(&good().concat()).unwrap();
    assert!(report.agrees(), "{report}");
    assert_eq!(report.cycles, 3);
    assert_eq!(report.taken, 3);
    // 18 = x, y, p, on, c and the out-port of f in three cycles. k.outLastUpdated is an input; p is absent once, c and
    // f once.
    assert_eq!(report.compared.values + report.compared.absences, 18);
    assert_eq!(report.compared.absences, 3);
}

#[test]
fn a_wrong_value_is_named_with_the_way_that_led_to_it() {
    let [a, b, c] = good();
    let report = run(&[a, b.replace("y.outValue 4.0", "y.outValue 4.25"), c].concat()).unwrap();
    assert_eq!(report.differing, 1);
    let first = report.first.unwrap();
    assert_eq!((first.cycle, first.path.len()), (2, 1));
    let link = &first.path[0];
    assert_eq!(
        (link.port.as_str(), link.primitive.as_str()),
        ("y.outValue", "Core::DoubleAdd")
    );
    assert_eq!(
        (link.computed.as_str(), link.recorded.as_deref()),
        ("4.0", Some("4.25"))
    );
    assert_eq!(link.inputs[0].1, "x.outValue");
}

#[test]
fn the_way_goes_back_to_where_values_begin_to_be_off() {
    let [a, b, c] = good();
    let off = |text: String| text.replace("x.outValue 2.0", "x.outValue 2.0000000001");
    let report = run(&[a, off(b).replace("y.outValue 4.0", "y.outValue 4.1"), c].concat()).unwrap();
    let path: Vec<String> = report
        .first
        .unwrap()
        .path
        .into_iter()
        .map(|l| l.port)
        .collect();
    assert_eq!(path, ["y.outValue", "x.outValue"]);
}

#[test]
fn absence_is_compared_too() {
    let [a, b, c] = good();
    let report = run(&[a, b.replace("2 p.outValue 1.0\n", ""), c].concat()).unwrap();
    assert_eq!(report.differing, 1);
    assert_eq!(report.ports[0].worst, None);
    let [a, b, c] = good();
    let report = run(&[a + "1 p.outValue 0.0\n", b, c].concat()).unwrap();
    assert_eq!(report.ports[0].port, "p.outValue");
}

#[test]
fn an_inactive_fragment_is_absent_inside_and_at_its_border() {
    let [a, b, c] = good();
    let report = run(&[a, b, c + "3 f.outC 5.0\n"].concat()).unwrap();
    assert_eq!(report.ports[0].port, "f.outC");
    assert_eq!(report.differing, 1);
}

#[test]
fn a_cycle_without_rows_is_a_cycle_in_which_everything_was_absent() {
    let report = run(&cycle(2, 1.0, 0.5, None)).unwrap();
    // Without the input no value is computed. The fragment is active, because only an explicit false deactivates it.
    let first: Vec<&str> = report
        .ports
        .iter()
        .filter(|p| p.first_cycle == 1)
        .map(|p| p.port.as_str())
        .collect();
    assert_eq!(first, ["f/c.outValue", "f.outC"]);
}

#[test]
fn a_trace_of_another_net_does_not_agree() {
    let report = run(&(good().concat() + "1 z.outValue 1.0\n")).unwrap();
    assert_eq!(report.unmatched, ["z.outValue"]);
    assert!(!report.agrees());
}

#[test]
fn a_value_of_another_type_differs() {
    let [a, b, c] = good();
    let report = run(&[a, b.replace("on.outValue true", "on.outValue 1.5"), c].concat()).unwrap();
    assert_eq!(
        (report.differing, report.ports[0].port.as_str()),
        (1, "on.outValue")
    );
    let [a, b, c] = good();
    let report = run(&[a, b.replace("k.outValue 3.0", "k.outValue yes"), c].concat()).unwrap();
    assert_eq!(report.ports[0].port, "k.outValue");
}

#[test]
fn a_trace_without_a_cycle_has_nothing_to_compare() {
    let report = run("").unwrap();
    assert!(report.agrees() && report.cycles == 0);
}

#[test]
fn an_empty_trace_is_bad_input() {
    let trace = Trace::parse("").unwrap();
    let error = replay(&net(NET), &trace, &Options::default());
    assert_eq!(error, Err(ReplayError::EmptyTrace));
}

#[test]
fn what_depends_on_something_not_recorded_is_not_compared() {
    let header = "cycle,primitive,type,port,value";
    let chosen = format!("{header}\n1,k,T,outValue,1.0\n3,k,T,outValue,2.0\n");
    let listed = format!("{header}\n1,y,T,inFirst,0.5\n2,y,T,inFirst,9.0\n3,y,T,inFirst,9.0\n");
    let trace = Trace::parse(&listed)
        .unwrap()
        .merged_with(&Trace::parse(&chosen).unwrap());
    let report = replay(&net(NET), &trace, &Options::default()).unwrap();
    assert!(
        report
            .ports
            .iter()
            .all(|p| p.port != "y.inFirst" || p.first_cycle == 1),
        "{report}"
    );
    assert!(report.unknown >= 2, "{report}");
}
