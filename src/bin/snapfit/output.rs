//! Writing results: to standard output, or to a file that is whole or as it was.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes a result to a file, or to standard output (None or `-`).
pub(crate) fn write(to: Option<&Path>, text: &str) -> Result<(), String> {
    let Some(path) = to.filter(|p| *p != Path::new("-")) else {
        let mut out = io::stdout().lock();
        return match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            // A reader that has seen enough is no failure.
            Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(format!("standard output: {e}")),
            _ => Ok(()),
        };
    };
    replace(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// Whether two paths mean one file.
fn same(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// Refuses to write two results to one file.
pub(crate) fn apart(one: Option<&Path>, other: Option<&Path>) -> Result<(), String> {
    match (one, other) {
        (Some(a), Some(b)) if a != Path::new("-") && same(a, b) => Err(format!(
            "{}: two results go to this file; one would be lost",
            a.display()
        )),
        _ => Ok(()),
    }
}

/// Refuses an output path that is the input file.
pub(crate) fn spare_input(input: &Path, out: Option<&Path>) -> Result<(), String> {
    match out {
        Some(out) if input != Path::new("-") && same(input, out) => Err(format!(
            "{}: this is the input; it would be lost",
            out.display()
        )),
        _ => Ok(()),
    }
}

/// Refuses an output path that cannot be written to, before any work is done for it.
pub(crate) fn prepare(input: &Path, out: Option<&Path>) -> Result<(), String> {
    spare_input(input, out)?;
    let Some(path) = out.filter(|p| *p != Path::new("-")) else {
        return Ok(());
    };
    let shown = path.display();
    if path.is_dir() {
        return Err(format!(
            "{shown}: this is a directory; give the name of a file in it"
        ));
    }
    let within = path.parent().filter(|p| !p.as_os_str().is_empty());
    match within {
        Some(dir) if !dir.exists() => Err(format!(
            "{shown}: there is no directory {}; make it first",
            dir.display()
        )),
        Some(dir) if !dir.is_dir() => Err(format!("{shown}: {} is not a directory", dir.display())),
        _ => Ok(()),
    }
}

/// Writes beside the file, then renames over it.
fn replace(path: &Path, text: &str) -> io::Result<()> {
    // Through a symbolic link, so that the link stays one.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(|m| !m.is_file()) {
        // A device or a pipe has no content to lose; a directory refuses by itself.
        return match fs::OpenOptions::new()
            .write(true)
            .open(&target)?
            .write_all(text.as_bytes())
        {
            Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
            other => other,
        };
    }
    let (beside, mut file) = create_beside(&target)?;
    let written = (|| {
        file.write_all(text.as_bytes())?;
        if let Some(old) = old {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        fs::rename(&beside, &target)
    })();
    if written.is_err() {
        let _ = fs::remove_file(&beside);
    }
    written
}

fn create_beside(target: &Path) -> io::Result<(PathBuf, fs::File)> {
    let name = target.file_name().ok_or(ErrorKind::InvalidInput)?;
    let mut attempt = 0;
    loop {
        let mut beside = std::ffi::OsString::from(".");
        beside.push(name);
        beside.push(format!(".{}-{attempt}.part", std::process::id()));
        let beside = target.with_file_name(beside);
        match fs::OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&beside)
        {
            Ok(file) => return Ok((beside, file)),
            Err(e) if e.kind() == ErrorKind::AlreadyExists && attempt < 100 => attempt += 1,
            Err(e) => return Err(e),
        }
    }
}
