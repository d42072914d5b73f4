//! Tests the passes on small nets with known results, and on every recorded net.

mod nets;

use rpi_diag::Code;
use rpi_net::passes::{Analysis, FlowPresence, PASSES, analyse};
use rpi_net::{Item, Net, NodeId, PortRef};

fn analysed(text: &str) -> Analysis {
    analyse(nets::net("test", text), |_| false).expect("the passes keep their promises")
}

/// Out-port of the node with this name.
fn port(net: &Net, name: &str, port: u8) -> PortRef {
    let node = net.node_ids().find(|id| net.node(*id).name == name);
    PortRef {
        node: node.expect("a node has this name"),
        port,
    }
}

/// Names of the nodes in order of evaluation.
fn order(analysis: &Analysis) -> Vec<&str> {
    let schedule = analysis.schedule.as_ref().expect("there is a schedule");
    let name = |id: NodeId| analysis.net.node(id).name.as_str();
    schedule.nodes().map(name).collect()
}

#[test]
fn declaration_order_breaks_ties() {
    let analysis = analysed(
        "{z=Core::DoubleAdd(inFirst=b.outValue),a=Core::Clock(),f={i=Core::Clock()}(),b=Core::Clock()}",
    );
    assert_eq!(order(&analysis), ["a", "i", "b", "z"]);
}

#[test]
fn a_fragment_waits_for_all_that_is_read_inside_and_for_its_activation() {
    let analysis = analysed(
        "{f={i=Core::DoublePre(inValue=parent.x),j=Core::Clock(),o=j.outValue}(x=late.outValue,inActive=on.outValue),\
        r=Core::DoubleAdd(inFirst=f.o),late=Core::Clock(),on=Core::DoubleGreater(inFirst=late.outValue)}",
    );
    assert_eq!(order(&analysis), ["late", "on", "i", "j", "r"]);
}

#[test]
fn a_delay_waits_for_nothing_at_its_own_level() {
    let analysis = analysed(
        "{a=Core::DoubleAdd(inFirst=p.outValue,Second='1.0'),p=Core::DoublePre(inValue=a.outValue)}",
    );
    assert_eq!(order(&analysis), ["p", "a"]);
}

#[test]
fn a_ring_is_named_by_its_shortest_way() {
    let analysis = analysed(
        "{a=Core::DoubleAdd(inFirst=d.outValue,inSecond=c.outValue),b=Core::DoubleAdd(inFirst=a.outValue),\
        c=Core::DoubleAdd(inFirst=b.outValue),d=Core::DoubleAdd(inFirst=c.outValue)}",
    );
    assert!(analysis.schedule.is_none());
    let messages: Vec<&str> = analysis
        .diagnostics
        .iter()
        .map(|f| f.message.as_str())
        .collect();
    assert_eq!(
        messages,
        ["`a` depends on itself in the same cycle: `a` -> `b` -> `c` -> `a`"]
    );
    assert_eq!(analysis.diagnostics[0].code, Code::RPI4001);
    let labels: Vec<&str> = analysis.diagnostics[0]
        .labels
        .iter()
        .map(|l| l.text.as_str())
        .collect();
    assert_eq!(
        labels,
        [
            "`b` reads `a` here",
            "`c` reads `b` here",
            "`a` reads `c` here"
        ]
    );
}

#[test]
fn every_ring_has_its_own_finding() {
    let analysis = analysed(
        "{a=Core::DoubleAdd(inFirst=a.outValue),f={b=Core::BooleanNot(inValue=c.outValue),\
        c=Core::BooleanNot(inValue=b.outValue)}(),g={h=Core::BooleanNot(Value='true'),o=h.outValue}(inActive=g.o)}",
    );
    let messages: Vec<&str> = analysis
        .diagnostics
        .iter()
        .map(|f| f.message.as_str())
        .collect();
    assert_eq!(
        messages,
        [
            "`a` depends on itself in the same cycle: `a` -> `a`",
            "`g` depends on itself in the same cycle: `g` -> `g`",
            "`b` depends on itself in the same cycle: `b` -> `c` -> `b`",
        ]
    );
}

#[test]
fn a_delay_inside_a_fragment_breaks_a_ring_outside_as_one_outside_does() {
    let analysis = analysed(
        "{t=Core::Trigger(inOff=f.o),f={n=Core::BooleanNot(inValue=parent.i),p=Core::BooleanPre(inValue=n.outValue),\
        o=p.outValue}(inActive=t.outActive,i=t.outActive)}",
    );
    let net = &analysis.net;
    assert_eq!(net.nodes.len(), 4);
    assert_eq!(net.path(net.nodes[3].fragment, &net.nodes[3].name), "p");
    assert_eq!(net.nodes[3].inputs, net.nodes[2].inputs);
    assert_eq!(order(&analysis), ["p", "t", "n", "p"]);
}

#[test]
fn presence_follows_the_rules_of_the_primitives() {
    let analysis = analysed(
        "{c=Core::Clock(),g=Core::DoubleGreater(inFirst=c.outValue),s=Core::DoubleSetNull(inValue=c.outValue,inNull=g.outValue),\
        a=Core::DoubleAdd(inFirst=s.outValue),n=Core::DoubleIsNull(inValue=s.outValue),\
        p=Core::DoublePre(inValue=c.outValue),k=Core::BooleanAnd(inFirst=g.outValue,inSecond=n.outValue),\
        f={i=Core::Clock(),o=i.outValue}(inActive=g.outValue),q=Core::DoubleAdd(inFirst=f.o),\
        never={i=Core::Clock(),o=i.outValue}(inActive=no.outValue),no=Core::BooleanValue(Value='false'),\
        r=Core::DoubleAdd(inFirst=never.o),always={i2=Core::Clock(),o=i2.outValue}(inActive=yes.outValue),\
        yes=Core::BooleanValue(Value='true'),u=Core::DoubleAdd(inFirst=always.o),\
        same={v=Core::DoubleAdd(inFirst=parent.x)}(inActive=g.outValue,x=f.o)}",
    );
    use FlowPresence::{Never, Optional, Total};
    let expected = [
        ("c", Total),
        ("g", Total),
        ("s", Optional),
        ("a", Optional),
        ("n", Total),
        ("p", Optional),
        ("k", Total),
        ("q", Optional),
        ("r", Never),
        ("u", Total),
        ("v", Total),
    ];
    for (name, sureness) in expected {
        let own = analysis.presences.own(port(&analysis.net, name, 0));
        assert_eq!(own, sureness, "{name}");
    }
}

#[test]
fn ports_forced_by_a_replay_are_optional() {
    let net = nets::net(
        "test",
        "{c=Core::Clock(),a=Core::DoubleAdd(inFirst=c.outValue)}",
    );
    let clock = port(&net, "c", 0);
    let analysis = analyse(net, |p| p == clock).expect("the passes keep their promises");
    let own = |name| analysis.presences.own(port(&analysis.net, name, 0));
    assert_eq!(
        (own("c"), own("a")),
        (FlowPresence::Optional, FlowPresence::Optional)
    );
}

#[test]
fn every_recorded_net_passes() {
    let Some(all) = nets::all() else { return };
    for (name, text) in &all {
        let analysis = analyse(nets::net(name, text), |_| false).expect("no pass breaks a promise");
        assert!(
            analysis.diagnostics.is_empty(),
            "{}",
            nets::rendered(name, text, &analysis.diagnostics)
        );
        let schedule = analysis.schedule.expect("it has no ring");
        assert_eq!(schedule.nodes().count(), analysis.net.nodes.len());
        assert!(!matches!(
            schedule.run(rpi_net::FragmentId::ROOT, 0),
            [Item::Fragment(_)]
        ));
    }
}

#[test]
fn each_pass_says_what_it_does() {
    let analysis = analysed("{c=Core::Clock()}");
    let reported: Vec<&str> = analysis.summary.iter().map(|(name, _)| *name).collect();
    let names: Vec<&str> = PASSES.iter().map(|p| p.name).collect();
    assert_eq!(reported, names);
    assert!(PASSES.iter().all(|p| !p.description.is_empty()));
}

/// For each pair of writers of a net, whether it is proved exclusive.
fn verdicts(text: &str) -> Vec<bool> {
    analysed(text)
        .writers
        .pairs
        .iter()
        .map(|p| p.exclusive)
        .collect()
}

/// Net with two writers of one output, activated by these two conditions.
fn two_writers(conditions: &str, first: &str, second: &str) -> String {
    let writer = "{w=IO::OutBool(inIO=parent.i,DeviceID='io',Port='1')}";
    format!(
        "{{v=Core::BooleanNetcommIn(Key='v'),n=Core::IntNetcommIn(Key='n'),t=Core::BooleanValue(Value='true'),\
        {conditions},a={writer}(inActive={first}.outValue,i=v.outValue),b={writer}(inActive={second}.outValue,i=v.outValue)}}"
    )
    .replace("x.outValue", "x.outActive")
    .replace("y.outValue", "y.outActive")
}

#[test]
fn writers_are_exclusive_where_it_can_be_proved() {
    let proved = [
        ("p=Core::BooleanNot(inValue=v.outValue)", "v", "p"),
        (
            "p=Core::IntEquals(inFirst=n.outValue,Second='1'),q=Core::IntEquals(inFirst=n.outValue,Second='2')",
            "p",
            "q",
        ),
        (
            "p=Core::IntGreater(inFirst=n.outValue,Second='3'),g=Core::IntGreater(inFirst=n.outValue,Second='1'),q=Core::BooleanNot(inValue=g.outValue)",
            "p",
            "q",
        ),
        (
            "f=Core::EdgeDetection(inValue=t.outValue),o=Core::BooleanNot(inValue=v.outValue),\
            k=Core::BooleanAnd(inFirst=f.outValue,inSecond=v.outValue),l=Core::BooleanAnd(inFirst=f.outValue,inSecond=o.outValue),\
            x=Core::Trigger(inOn=k.outValue),y=Core::Trigger(inOn=l.outValue)",
            "x",
            "y",
        ),
        (
            "f=Core::EdgeDetection(inValue=v.outValue),x=Core::Trigger(On='true',inOff=f.outValue),y=Core::Trigger(inOn=f.outValue)",
            "x",
            "y",
        ),
    ];
    for (conditions, first, second) in proved {
        assert_eq!(
            verdicts(&two_writers(conditions, first, second)),
            [true],
            "{conditions}"
        );
    }
}

#[test]
fn writers_that_may_meet_are_watched() {
    let open = [
        ("p=Core::BooleanNetcommIn(Key='p')", "v", "p"),
        (
            "p=Core::IntEquals(inFirst=n.outValue,Second='1'),q=Core::IntEquals(inFirst=n.outValue,Second='2',Epsilon='1')",
            "p",
            "q",
        ),
        (
            "o=Core::BooleanNot(inValue=v.outValue),x=Core::Trigger(inOn=v.outValue),y=Core::Trigger(inOn=o.outValue)",
            "x",
            "y",
        ),
    ];
    for (conditions, first, second) in open {
        assert_eq!(
            verdicts(&two_writers(conditions, first, second)),
            [false],
            "{conditions}"
        );
    }
}

#[test]
fn joints_and_tool_of_one_arm_are_one_motion() {
    let net = |robot: &str| {
        format!(
            "{{m=CartesianPosition::CartesianMonitor(Robot='a'),c=CartesianPosition::CartesianPosition(inPosition=m.outCommandedPosition,Robot='a'),\
            d=Core::Clock(),j=RobotArm::JointPosition(inPosition=d.outValue,Robot='{robot}',Axis='0')}}"
        )
    };
    assert_eq!(verdicts(&net("a")), [false]);
    assert_eq!(verdicts(&net("b")), [false; 0]);
}

#[test]
fn of_exclusive_fragments_the_largest_counts() {
    let body = "{a=Core::DoubleAdd(),b=Core::DoubleAdd()}";
    let work = |second: &str| {
        let text = format!(
            "{{v=Core::BooleanNetcommIn(Key='v'),p=Core::BooleanNot(inValue=v.outValue),\
            f={body}(inActive=v.outValue),g={body}(inActive={second}.outValue)}}"
        );
        analysed(&text).work.bound(rpi_net::FragmentId::ROOT)
    };
    assert_eq!(work("v") - work("p"), 2);
}

#[test]
fn effects_reach_back_through_activations() {
    let analysis = analysed(
        "{v=Core::BooleanNetcommIn(Key='v'),p=Core::BooleanNot(inValue=v.outValue),dead=Core::Clock(),\
        f={w=IO::OutBool(IO='true',DeviceID='io',Port='1'),idle=Core::Clock()}(inActive=p.outValue)}",
    );
    let live = rpi_net::passes::mark_live::mark_live(&analysis.net);
    let names = analysis
        .net
        .nodes
        .iter()
        .zip(live)
        .filter(|(_, l)| *l)
        .map(|(n, _)| n.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["v", "p", "w"]);
}
