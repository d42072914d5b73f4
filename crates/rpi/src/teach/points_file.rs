//! File with the points: new ones are added at its end, so that everything else in it stays as it is.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::arm_jog::Place;
use rpi_sim::{PointsFile, TaughtPose};

/// File with points, to which points are added. It is read again for each change, because others may edit it meanwhile.
pub(super) struct PointList {
    path: PathBuf,
    /// Frame in which new points are given, with its pose in the base of the arm; `None` for the base.
    frame: Option<(String, TaughtPose)>,
    /// Names and texts of the points that were added.
    added: Vec<(String, String)>,
}

impl PointList {
    /// Opens the file, or begins a new one. `frame` is the name of the frame in which new points are given.
    ///
    /// # Errors
    /// Returns an error if the file is invalid, or has no such frame in the base of the arm.
    pub(super) fn open(path: &Path, frame: Option<&str>) -> Result<PointList, Box<dyn Error>> {
        let mut list = PointList {
            path: path.to_owned(),
            frame: None,
            added: Vec::new(),
        };
        let text = list.read()?;
        let file = list.parse(&text)?;
        if let Some(wanted) = frame {
            let found = file.frames.iter().find(|frame| frame.name == wanted);
            let found = found.filter(|frame| frame.parent.is_none());
            let why = || {
                let file = path.display();
                format!(
                    "{file}: no frame `{wanted}` in the base of the arm; write [frames.{wanted}]"
                )
            };
            list.frame = Some((wanted.to_owned(), found.ok_or_else(why)?.pose));
        }
        Ok(list)
    }

    fn read(&self) -> Result<String, String> {
        match rpi_files::read_text(&self.path, rpi_files::MAX_DESCRIPTION) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(String::new()),
            text => text.map_err(|error| format!("{}: {error}", self.path.display())),
        }
    }

    fn parse(&self, text: &str) -> Result<PointsFile, String> {
        let file = PointsFile::parse(&self.path.display().to_string(), text);
        file.map_err(|errors| format!("the points are invalid\n{errors}"))
    }

    /// Returns the number of points that were added and not removed.
    pub(super) fn taken(&self) -> usize {
        self.added.len()
    }

    /// Adds a point at this place, and writes the file. Without a name, the point gets the first free one of `p1`, `p2`, ...
    /// Returns the name, or the reason why nothing is added: a name that is invalid or in use.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or written, or has become invalid.
    pub(super) fn add(
        &mut self,
        name: Option<&str>,
        place: &Place,
    ) -> Result<Result<String, String>, Box<dyn Error>> {
        let before = self.read()?;
        let file = self.parse(&before)?;
        let name = name.map_or_else(|| free_name(&file), str::to_owned);
        let separator = if before.is_empty() { "" } else { "\n" };
        let entry = format!("{separator}{}", self.entry(&name, place));
        let text = format!("{before}{entry}");
        // The whole file must stay valid: this finds names that are invalid or in use.
        if let Some(error) = rpi_driver::check_points(&self.path, &text)
            .into_iter()
            .next()
        {
            return Ok(Err(error.message));
        }
        self.write(&text)?;
        self.added.push((name.clone(), entry));
        Ok(Ok(name))
    }

    fn entry(&self, name: &str, place: &Place) -> String {
        let mut entry = format!("[points.{name}]\n");
        let pose = match &self.frame {
            Some((frame, pose)) => {
                let _ = writeln!(entry, "in = \"{frame}\"");
                place.pose.relative_to(pose)
            }
            None => place.pose,
        };
        let _ = writeln!(entry, "position = {:?}", pose.position);
        let _ = writeln!(entry, "quaternion = {:?}", pose.quaternion());
        let _ = writeln!(entry, "joints = {:?}", place.joints);
        entry
    }

    /// Removes the point that was added last, and returns its name; `None` if there is none.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or written, or the entry has been changed meanwhile.
    pub(super) fn remove_last(&mut self) -> Result<Option<String>, Box<dyn Error>> {
        let Some((name, entry)) = self.added.pop() else {
            return Ok(None);
        };
        let text = self.read()?;
        let Some(at) = text.rfind(&entry) else {
            let file = self.path.display();
            return Err(
                format!("{file}: the entry of `{name}` has been changed; remove it there").into(),
            );
        };
        self.write(&format!("{}{}", &text[..at], &text[at + entry.len()..]))?;
        Ok(Some(name))
    }

    /// Writes the file at once as a whole: a crash leaves the old or the new one.
    fn write(&self, text: &str) -> Result<(), Box<dyn Error>> {
        let mut new = self.path.clone().into_os_string();
        new.push(".new");
        let written = std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, &self.path));
        written.map_err(|why| format!("{}: {why}", self.path.display()).into())
    }
}

/// Returns the first of the names `p1`, `p2`, ... that no entry of the file has.
fn free_name(file: &PointsFile) -> String {
    let frames = file.frames.iter().map(|frame| &frame.name);
    let tools = file.tools.iter().map(|tool| &tool.name);
    let points = file.points.iter().map(|point| &point.name);
    let names: std::collections::BTreeSet<&String> = frames.chain(tools).chain(points).collect();
    let mut free = (1..).map(|k| format!("p{k}"));
    free.find(|name| !names.contains(name)).unwrap_or_default()
}
