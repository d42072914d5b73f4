//! `rpi teach`: moves an arm by keys and writes its points to a file that programs use.
//!
//! | file | idea |
//! |---|---|
//! | `keys.rs` | meaning of the keys |
//! | `terminal.rs` | keys of the terminal, without waiting for the end of a line |
//! | `arm_jog.rs` | command on the server that moves the arm (`jog.rpi`) |
//! | `points_file.rs` | file with the points |

mod arm_jog;
mod keys;
mod points_file;
mod terminal;

use std::error::Error;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use rpi_client::Client;
use rpi_serve::{CompilerSettings, Server, Settings};

use crate::cell_file;
use crate::exit::{CommandResult, Exit};
use crate::interrupt::Interrupt;
use arm_jog::{ArmJog, Motion};
use keys::{HELP, Key};
use points_file::PointList;
use terminal::{Input, Terminal};

/// Options of `rpi teach`.
#[derive(Debug, Args)]
pub(crate) struct TeachArgs {
    /// File with the points (TOML): points are added to it. It need not exist.
    #[arg(default_value = "points.toml")]
    points: PathBuf,
    /// Cell description whose arm is simulated; default `cell.toml` beside the points.
    #[arg(long, value_name = "FILE", conflicts_with = "connect")]
    cell: Option<PathBuf>,
    /// Move the arm of the server at this address instead of a simulated one.
    #[arg(long, value_name = "HOST:PORT")]
    connect: Option<String>,
    /// File with the token for the server, on its first line.
    #[arg(long, value_name = "FILE", requires = "connect")]
    token_file: Option<PathBuf>,
    /// Name of the arm; required if the cell has several.
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    /// Frame of the file in which the points are given; default: the base of the arm.
    #[arg(long, value_name = "NAME")]
    frame: Option<String>,
    /// Time for which the arm moves after each key.
    #[arg(long, value_name = "TIME", default_value = "150ms", value_parser = rpi_driver::parse_duration)]
    hold: u64,
}

/// Connection to the server with the arm. A simulated arm has a server in this process.
struct Connection {
    client: Client,
    server: Option<Server>,
    /// Name and device type of the arm.
    arm: (String, String),
}

/// Carries out `rpi teach`: reads keys until the end of the input, `q` or a signal. Each point is written at once.
pub(crate) fn teach(args: &TeachArgs) -> CommandResult {
    let mut points = PointList::open(&args.points, args.frame.as_deref())?;
    let interrupt = Interrupt::listen()?;
    let connection = connect(args)?;
    let mut jog = ArmJog::new(&connection.client, &connection.arm, args.hold)?;
    let terminal = Terminal::open(interrupt.flag())?;
    rpi_diag::print_stderr!("{HELP}");
    let done = handle_keys(&terminal, &mut jog, &mut points, &interrupt);
    drop(terminal);
    // The arm stops on its path before the server closes.
    let stopped = jog.close();
    if let Some(server) = connection.server {
        server.close().map_err(|why| why.to_string())?;
    }
    done.and(stopped)?;
    let count = rpi_diag::with_noun(points.taken(), "point");
    rpi_cli::print(format!("{}: {count} taken\n", args.points.display()))?;
    Ok(interrupt.exit().unwrap_or(Exit::Success))
}

fn handle_keys(
    terminal: &Terminal,
    jog: &mut ArmJog,
    points: &mut PointList,
    interrupt: &Interrupt,
) -> Result<(), Box<dyn Error>> {
    let interrupted = interrupt.flag();
    while !interrupted.load(Ordering::Relaxed) {
        let key = match terminal.read()? {
            Input::Key(byte) => Key::from_byte(byte),
            Input::Nothing => continue,
            Input::End => return Ok(()),
        };
        match key {
            Some(Key::Quit) => return Ok(()),
            Some(Key::Move(motion)) => jog.press(&motion)?,
            Some(Key::Take) => take(jog, points, None, &interrupted)?,
            Some(Key::TakeNamed) => {
                if let Some(name) = terminal.line("name of the point: ")? {
                    take(jog, points, Some(name.trim()), &interrupted)?;
                }
            }
            Some(Key::Remove) => match points.remove_last()? {
                Some(name) => rpi_diag::println_stderr!("removed {name}"),
                None => rpi_diag::println_stderr!("no point was taken"),
            },
            Some(Key::Help) => rpi_diag::print_stderr!("{HELP}"),
            None => {}
        }
        // Keys from a file or a pipe follow one another at once: each motion ends before the next key counts.
        let moves = matches!(
            key,
            Some(Key::Move(Motion::Tool { .. } | Motion::Axis { .. }))
        );
        if moves && !terminal.is_interactive() {
            jog.wait_for_rest(&interrupted)?;
        }
    }
    Ok(())
}

/// Takes the place of the arm as a point, once the arm rests.
fn take(
    jog: &mut ArmJog,
    points: &mut PointList,
    name: Option<&str>,
    interrupted: &AtomicBool,
) -> Result<(), Box<dyn Error>> {
    jog.wait_for_rest(interrupted)?;
    let place = jog.place()?;
    match points.add(name, &place)? {
        Ok(name) => rpi_diag::println_stderr!("took {name}: {place}"),
        // A wrong name ends nothing: the arm is where it was.
        Err(why) => rpi_diag::println_stderr!("not taken: {why}"),
    }
    Ok(())
}

fn connect(args: &TeachArgs) -> Result<Connection, Box<dyn Error>> {
    let Some(address) = &args.connect else {
        return simulate(args);
    };
    let token = args.token_file.as_deref().map(first_line).transpose()?;
    let client = Client::connect(address, token.as_deref())?;
    let devices = client.devices()?;
    let arms: Vec<(&str, usize)> = devices
        .iter()
        .filter_map(|device| Some((device.name.as_str(), device.joint_count?)))
        .collect();
    let arm = choose_arm(&arms, args.arm.as_deref()).map_err(|why| format!("{address}: {why}"))?;
    Ok(Connection {
        client,
        server: None,
        arm,
    })
}

fn first_line(path: &Path) -> Result<String, String> {
    let text = rpi_files::read_text(path, rpi_files::MAX_DESCRIPTION);
    let text = text.map_err(|why| format!("{}: {why}", path.display()))?;
    Ok(text.lines().next().unwrap_or_default().trim().to_owned())
}

/// Starts a server in this process with the simulated cell, and connects to it.
fn simulate(args: &TeachArgs) -> Result<Connection, Box<dyn Error>> {
    let beside = || args.points.with_file_name("cell.toml");
    let path = args.cell.clone().unwrap_or_else(beside);
    let (cell, _) = cell_file::read(&path)?;
    let arms: Vec<(&str, usize)> = cell.arms().collect();
    let arm = choose_arm(&arms, args.arm.as_deref());
    let arm = arm.map_err(|why| format!("{}: {why}", path.display()))?;
    let settings = Settings {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        compiler: CompilerSettings::InProcess,
        ..Settings::default()
    };
    let server = Server::open(&cell, &settings, ()).map_err(|why| why.to_string())?;
    Ok(Connection {
        client: Client::connect(&server.address().to_string(), None)?,
        server: Some(server),
        arm,
    })
}

/// Returns name and device type of the arm called `wanted`, or of the only one of `arms`: names with numbers of axes.
fn choose_arm(arms: &[(&str, usize)], wanted: Option<&str>) -> Result<(String, String), String> {
    let names = || {
        let names: Vec<&str> = arms.iter().map(|(name, _)| *name).collect();
        names.join(", ")
    };
    let chosen = match (wanted, arms) {
        (Some(wanted), all) => all.iter().find(|(name, _)| *name == wanted),
        (None, [only]) => Some(only),
        (None, _) => None,
    };
    match (chosen, wanted, arms.len()) {
        (Some((name, axes)), ..) => Ok(((*name).to_owned(), format!("Arm<<{axes}>>"))),
        (None, _, 0) => Err("the cell has no arm".to_owned()),
        (None, Some(wanted), _) => Err(format!("no arm `{wanted}`; the arms are {}", names())),
        (None, None, _) => Err(format!("several arms; choose one by --arm: {}", names())),
    }
}
