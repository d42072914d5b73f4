//! What the page of `rpi view` requests about a recording: values of all flows in a cycle, single flows, and causes.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use rpi_debug::{Debugger, RecordedProgram, RunningCommand};
use rpi_record::mcap::{Recording, RunData};
use rpi_view::{Precision, ViewContent, ViewSource};
use serde_json::{Map, Value, json};

use crate::recorded_nets::RecordedNets;
use crate::recorded_run::LoadedRun;
use crate::{watched_recording, why};

/// A recording as the page shows it.
pub(crate) struct RecordedSource {
    document: Arc<[u8]>,
    recording: Recording,
    program: Option<PathBuf>,
    /// Replay with all flows, which begins with the first request for them.
    debugger: Mutex<Option<Debugger>>,
}

impl RecordedSource {
    /// Creates the source of a recording. `program` is the file of its program, which is needed if the program consists of several.
    pub(crate) fn new(loaded: LoadedRun, program: Option<&Path>) -> RecordedSource {
        let nets = RecordedNets::new(&loaded.recording, program);
        let content = nets.content(&loaded.run);
        RecordedSource {
            document: rpi_view::document(content, Precision::Exact).into(),
            recording: loaded.recording,
            program: nets.program,
            debugger: Mutex::default(),
        }
    }

    fn new_debugger(&self) -> Result<Debugger, String> {
        let program = RecordedProgram::new(&self.recording, self.program.as_deref());
        let program = program.map_err(|error| error.to_string())?;
        Debugger::new(self.recording.clone(), program).map_err(|error| error.to_string())
    }

    /// Replays the recording with one flow more.
    fn watched(&self, name: &str) -> Result<RunData, String> {
        let mut recording = self.recording.clone();
        let names = [name.to_owned()];
        watched_recording::watch(&mut recording, &names, self.program.as_deref())
            .map_err(|error| error.to_string())?;
        let run = recording.values_by_flow(0..u64::MAX);
        run.map_err(|error| error.to_string())
    }
}

impl ViewSource for RecordedSource {
    fn document(&self) -> Arc<[u8]> {
        Arc::clone(&self.document)
    }

    fn since(&self, _tick: u64) -> Option<Vec<u8>> {
        None
    }

    fn cycle(&self, tick: u64) -> Result<String, String> {
        let mut debugger = self.debugger.lock().unwrap_or_else(PoisonError::into_inner);
        if debugger.is_none() {
            *debugger = Some(self.new_debugger()?);
        }
        let Some(debugger) = &mut *debugger else {
            return Err("there is no replay".to_owned());
        };
        debugger.go_to(tick).map_err(|error| error.to_string())?;
        let stop = debugger.stop();
        let commands = stop.commands.iter().map(|c| command_values(debugger, c));
        let answer = json!({ "tick": stop.tick, "commands": commands.collect::<Vec<_>>() });
        Ok(answer.to_string())
    }

    fn flow(&self, name: &str) -> Result<Vec<u8>, String> {
        let (command, path) = name.split_once('.').unwrap_or((name, ""));
        let topic = format!("/command/{command}");
        let mut run = self.watched(name)?;
        run.topics.retain(|known| known.name == topic);
        for topic in &mut run.topics {
            topic.columns.retain(|column| {
                let rest = column.name.strip_prefix(path);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
            });
        }
        run.topics.retain(|topic| !topic.columns.is_empty());
        match run.topics.is_empty() {
            true => Err(format!("`{name}` has no values in this recording")),
            false => Ok(rpi_view::document(
                ViewContent {
                    run: &run,
                    nets: Ok(&[]),
                    is_live: false,
                },
                Precision::Exact,
            )),
        }
    }

    fn why(&self, tick: u64, name: &str) -> Result<String, String> {
        let mut recording = self.recording.clone();
        let question = why::Question {
            flow: name,
            until: tick,
            program: self.program.as_deref(),
        };
        let explained = why::explain(&mut recording, &question);
        explained
            .map(|explained| explained.json().to_string())
            .map_err(|error| error.to_string())
    }
}

/// Returns the values of a command by the names of the flows, without the command; `null` for an absent one.
fn command_values(debugger: &Debugger, command: &RunningCommand) -> Value {
    let table = &debugger.tables()[command.table];
    let mut values = Map::new();
    for (k, flow) in table.flows.iter().enumerate() {
        let path = flow.path.strip_prefix(&table.command);
        let path = path.and_then(|path| path.strip_prefix('.'));
        let is_present = command.values.get(k).is_some_and(Option::is_some);
        if let Some(path) = path {
            let text = is_present.then(|| command.text(table, k));
            values.insert(path.to_owned(), json!(text));
        }
    }
    json!({
        "name": table.command,
        "id": command.id.to_number(),
        "cycle": command.cycle,
        "values": values,
    })
}
