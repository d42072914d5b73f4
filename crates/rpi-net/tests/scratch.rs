mod nets;
use rpi_diag::FileId;
use std::time::Instant;
use rpi_net::passes::*;
#[test]
fn scratch() {
    let all = nets::nets_in("v1").unwrap();
    let (name, text) = all.iter().find(|(n, _)| n.contains("seq-011")).unwrap();
    for _ in 0..8 {
        let t = Instant::now();
        let (net, _) = rpi_net::rpinet::read(name, FileId(0), text);
        let a = t.elapsed();
        let net = net.unwrap();
        let t = Instant::now();
        let an = analyse(net, |_| false).unwrap();
        let all = t.elapsed();
        let t = Instant::now();
        let w = rpi_net::rpinet::write(&an.net);
        println!("read {a:?} all passes {all:?}  write {:?} {}", t.elapsed(), w.len());
        for t in an.told { println!("   {t:?}"); }
    }
}
