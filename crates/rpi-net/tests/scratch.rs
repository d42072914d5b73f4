mod nets;
use rpi_diag::FileId;
use std::time::Instant;
#[test]
fn scratch() {
    let all = nets::all().unwrap();
    // spelling of the reference
    let (mut same, mut other) = (0, 0);
    for (name, text) in &all {
        let net = nets::net(name, text);
        let w = rpi_net::rpinet::write(&net);
        let get = |t: &str| -> Vec<String> {
            t.split('\'')
                .skip(1)
                .step_by(2)
                .map(str::to_owned)
                .collect::<std::collections::BTreeSet<_>>()
                .into_iter()
                .collect()
        };
        let orig: std::collections::BTreeSet<String> = get(text).into_iter().collect();
        for x in get(&w) {
            if orig.contains(&x) {
                same += 1
            } else {
                other += 1;
                if other < 60 {
                    println!("{name}: {x}");
                }
            }
        }
    }
    println!("same {same} other {other}");
    let (name, text) = all.iter().find(|(n, _)| n.contains("seq-011")).unwrap();
    for _ in 0..5 {
        let t = Instant::now();
        let (net, _) = rpi_net::rpinet::read(name, FileId(0), text);
        let a = t.elapsed();
        let net = net.unwrap();
        let t = Instant::now();
        let tree = rpi_net::Tree::new(&net);
        let users = rpi_net::passes::Users::new(&net);
        let deps = rpi_net::passes::Dependencies::new(&net, &tree);
        let b = t.elapsed();
        let t = Instant::now();
        let s = rpi_net::passes::Schedule::new(&deps).unwrap();
        let c = t.elapsed();
        let t = Instant::now();
        let p = rpi_net::passes::Presences::infer(&net, &tree, &users, |_| false);
        let d = t.elapsed();
        rpi_net::passes::schedule::verify(&net, &deps, &s).unwrap();
        p.verify(&net, &tree).unwrap();
        let t = Instant::now();
        let w = rpi_net::rpinet::write(&net);
        println!(
            "read {a:?} deps {b:?} sched {c:?} pres {d:?} write {:?} {}",
            t.elapsed(),
            w.len()
        );
        let n = net
            .node_ids()
            .flat_map(|id| {
                (0..net.node(id).outputs.len()).map(move |p| rpi_net::PortRef {
                    node: id,
                    port: p as u8,
                })
            })
            .filter(|r| p.own(*r) != rpi_net::passes::Sureness::Total)
            .count();
        println!("not total: {n} of {}", net.nodes.len());
    }
}
