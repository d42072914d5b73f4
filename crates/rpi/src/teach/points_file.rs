//! File with the points: new ones are added at its end, so that everything else in it stays as it is.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::arm_jog::Place;
use rpi_sim::{PointsFile, TaughtPose};

/// File with points, to which points are added.
pub(super) struct PointList {
    path: PathBuf,
    /// Frame in which new points are given, with its pose in the base of the arm; `None` for the base.
    frame: Option<(String, TaughtPose)>,
    text: String,
    /// Names of the points in the file.
    names: Vec<String>,
    /// Names of the points that were added, and the length of the text before each.
    added: Vec<(String, usize)>,
}

impl PointList {
    /// Opens the file, or begins a new one. `frame` is the name of the frame in which new points are given.
    ///
    /// # Errors
    /// Returns an error if the file is invalid, or has no such frame in the base of the arm.
    pub(super) fn open(path: &Path, frame: Option<&str>) -> Result<PointList, Box<dyn Error>> {
        let name = path.display().to_string();
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(format!("{name}: {error}").into()),
        };
        let file = PointsFile::parse(&name, &text);
        let file = file.map_err(|errors| format!("the points are invalid\n{errors}"))?;
        let frame = frame.map(|wanted| {
            let found = file.frames.iter().find(|frame| frame.name == wanted);
            let found = found.filter(|frame| frame.parent.is_none());
            let why = || {
                format!(
                    "{name}: no frame `{wanted}` in the base of the arm; write [frames.{wanted}]"
                )
            };
            Ok::<_, String>((wanted.to_owned(), found.ok_or_else(why)?.pose))
        });
        Ok(PointList {
            path: path.to_owned(),
            frame: frame.transpose()?,
            text,
            names: file.points.into_iter().map(|point| point.name).collect(),
            added: Vec::new(),
        })
    }

    /// Returns the number of points that were added and not removed.
    pub(super) fn taken(&self) -> usize {
        self.added.len()
    }

    /// Adds a point at this place, and writes the file. Without a name, the point gets the first free one of `p1`, `p2`, ...
    /// Returns the name.
    ///
    /// # Errors
    /// Returns an error if the name is invalid or in use, or the file cannot be written; then, nothing is added.
    pub(super) fn add(
        &mut self,
        name: Option<&str>,
        place: &Place,
    ) -> Result<String, Box<dyn Error>> {
        let free = || {
            (1..)
                .map(|k| format!("p{k}"))
                .find(|name| !self.names.contains(name))
        };
        let name = name.map(str::to_owned).or_else(free).unwrap_or_default();
        let before = self.text.len();
        let text = format!("{}{}", self.text, self.entry(&name, place));
        // The whole file must stay valid: this finds names that are invalid or in use.
        let valid = PointsFile::parse(&self.path.display().to_string(), &text);
        if let Some(first) = valid
            .err()
            .and_then(|errors| errors.errors.into_iter().next())
        {
            return Err(first.message.into());
        }
        self.write(&text)?;
        self.text = text;
        self.names.push(name.clone());
        self.added.push((name.clone(), before));
        Ok(name)
    }

    fn entry(&self, name: &str, place: &Place) -> String {
        let separator = if self.text.is_empty() { "" } else { "\n" };
        let mut entry = format!("{separator}[points.{name}]\n");
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
    /// Returns an error if the file cannot be written.
    pub(super) fn remove_last(&mut self) -> Result<Option<String>, Box<dyn Error>> {
        let Some((name, before)) = self.added.last().cloned() else {
            return Ok(None);
        };
        self.write(&self.text[..before])?;
        self.text.truncate(before);
        self.added.pop();
        self.names.retain(|other| *other != name);
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
