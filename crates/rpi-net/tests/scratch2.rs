mod nets;
use rpi_net::passes::*;
#[test]
fn scratch() {
    let all = nets::all().unwrap();
    let mut bad = 0;
    for (name, text) in &all {
        let mut net = nets::net(name, text);
        let n = rpi_net::passes::hoist::hoist_delays(&mut net);
        if n > 0 {
            println!("{name} {n}");
        }
        let tree = rpi_net::Tree::new(&net);
        let deps = Dependencies::new(&net, &tree);
        if Schedule::new(&deps).is_none() {
            bad += 1;
            println!("{name}");
            for f in causality::check(&net, &deps) {
                println!("{}", f.message);
            }
        }
    }
    println!("bad {bad}");
}
#[test]
fn scratch_eq() {
    let all = nets::all().unwrap();
    let mut n = 0;
    for (name, text) in &all {
        let a = nets::net(name, text);
        let b = nets::net(name, &rpi_net::rpinet::write(&a));
        assert_eq!(a.fragments.len(), b.fragments.len());
        for (x, y) in a.fragments.iter().zip(&b.fragments) {
            if x.inputs != y.inputs || x.outputs != y.outputs || x.activation != y.activation {
                println!("{name} FRAG {}", x.name);
            }
        }
        for (x, y) in a.nodes.iter().zip(&b.nodes) {
            if x.inputs != y.inputs
                || x.params != y.params
                || x.name != y.name
                || x.outputs != y.outputs
            {
                n += 1;
                if n < 30 {
                    println!(
                        "{name} {} {}\n {:?} {:?}\n {:?} {:?}",
                        x.name,
                        x.desc().name,
                        x.inputs,
                        x.params,
                        y.inputs,
                        y.params
                    );
                    println!(
                        "{}",
                        &text[x.origin.span.start as usize..x.origin.span.end as usize]
                    );
                }
            }
        }
    }
    println!("diff {n}");
}
