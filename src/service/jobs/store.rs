//! Where jobs are kept: records in an SQLite file, documents as files beside it.
//!
//! ```text
//! DIR/jobs.sqlite        one row a job: its id, the client's key, a record, a trail of checkpoints
//! DIR/documents/ID       the document as it was sent
//! DIR/documents/.ID.part one that is being written
//! ```
//!
//! A job is there when its row is: the document is written, synced and named before, the folder synced, and the row committed with a synced
//! log (`synchronous = FULL`). What a crash leaves is a document without a row, which is removed at the next start. A folder belongs to one
//! service at a time (`locking_mode = EXCLUSIVE`).

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rusqlite::{Connection, ErrorCode, OptionalExtension, params};

/// The store of a service. Its calls block.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    rows: Mutex<Connection>,
}

/// A row.
pub struct Row {
    /// The job's id.
    pub id: String,
    /// All that is known of it, as JSON.
    pub record: String,
    /// Its checkpoints.
    pub trail: Vec<u8>,
}

/// The layout of the tables.
const LAYOUT: i64 = 1;

impl Store {
    /// Opens the store of a folder, which is made if it is not there.
    ///
    /// # Errors
    /// It cannot be written; another service uses it; it was made by a later version.
    pub fn open(folder: &Path) -> io::Result<Store> {
        let at = |error: io::Error| {
            io::Error::new(error.kind(), format!("{}: no folder for jobs: {error}; name another with --data", folder.display()))
        };
        fs::create_dir_all(folder.join("documents")).and_then(|()| File::open(folder)?.sync_all()).map_err(at)?;
        let path = folder.join("jobs.sqlite");
        let rows = Connection::open(&path).and_then(|rows| {
            rows.pragma_update(None, "locking_mode", "EXCLUSIVE")?;
            rows.pragma_update_and_check(None, "journal_mode", "WAL", |_| Ok(()))?;
            rows.pragma_update(None, "synchronous", "FULL")?;
            rows.pragma_update_and_check(None, "journal_size_limit", 16 << 20, |_| Ok(()))?;
            rows.execute_batch(
                "BEGIN IMMEDIATE;
                 CREATE TABLE IF NOT EXISTS jobs (id TEXT PRIMARY KEY, key TEXT UNIQUE, record TEXT NOT NULL, trail BLOB NOT NULL DEFAULT '') STRICT, WITHOUT ROWID;
                 COMMIT;",
            )?;
            Ok(rows)
        });
        let rows = rows.map_err(|error| at(fault(error)))?;
        let layout: i64 = rows.pragma_query_value(None, "user_version", |row| row.get(0)).map_err(fault)?;
        if layout > LAYOUT {
            return Err(at(io::Error::other("the jobs here were stored by a later version of this program")));
        }
        if layout < LAYOUT {
            rows.pragma_update(None, "user_version", LAYOUT).map_err(fault)?;
        }
        let store = Store { folder: folder.to_owned(), rows: Mutex::new(rows) };
        store.sweep().map_err(at)?;
        Ok(store)
    }

    fn rows(&self) -> MutexGuard<'_, Connection> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes documents that belong to no job.
    fn sweep(&self) -> io::Result<()> {
        let ids: HashSet<String> = self.all()?.into_iter().map(|row| row.id).collect();
        for entry in fs::read_dir(self.documents())? {
            let entry = entry?;
            if !entry.file_name().to_str().is_some_and(|name| ids.contains(name)) {
                fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    }

    fn documents(&self) -> PathBuf {
        self.folder.join("documents")
    }

    /// Where the document of a job is.
    pub fn document(&self, id: &str) -> PathBuf {
        self.documents().join(id)
    }

    /// All rows, by id.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn all(&self) -> io::Result<Vec<Row>> {
        let rows = self.rows();
        let mut all = rows.prepare("SELECT id, record, trail FROM jobs ORDER BY id").map_err(fault)?;
        let row = |row: &rusqlite::Row<'_>| Ok(Row { id: row.get(0)?, record: row.get(1)?, trail: row.get(2)? });
        all.query_map([], row).and_then(Iterator::collect).map_err(fault)
    }

    /// Stores a document; only [`Store::add`] makes a job of it.
    ///
    /// # Errors
    /// It could not be stored; then nothing is left of it.
    pub fn write_document(&self, id: &str, bytes: &[u8]) -> io::Result<()> {
        let part = self.documents().join(format!(".{id}.part"));
        let written = (|| {
            let mut file = File::create_new(&part)?;
            file.write_all(bytes)?;
            file.sync_all()?;
            fs::rename(&part, self.document(id))?;
            File::open(self.documents())?.sync_all()
        })();
        written.inspect_err(|_| {
            // What cannot be removed now goes at the next start.
            let _ = fs::remove_file(&part);
            let _ = fs::remove_file(self.document(id));
        })
    }

    /// The job of a client's key.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn job_of(&self, key: &str) -> io::Result<Option<String>> {
        let rows = self.rows();
        rows.query_row("SELECT id FROM jobs WHERE key = ?1", [key], |row| row.get(0)).optional().map_err(fault)
    }

    /// Adds a job whose document is there. If its key has a job already, that job's id is given, and nothing is added.
    ///
    /// # Errors
    /// It could not be stored.
    pub fn add(&self, row: &Row, key: Option<&str>) -> io::Result<Option<String>> {
        let mut rows = self.rows();
        let transaction = rows.transaction().map_err(fault)?;
        if let Some(key) = key {
            let known = transaction.query_row("SELECT id FROM jobs WHERE key = ?1", [key], |row| row.get(0)).optional().map_err(fault)?;
            if known.is_some() {
                return Ok(known);
            }
        }
        let added = "INSERT INTO jobs (id, key, record, trail) VALUES (?1, ?2, ?3, ?4)";
        transaction.execute(added, params![row.id, key, row.record, row.trail]).map_err(fault)?;
        transaction.commit().map_err(fault)?;
        Ok(None)
    }

    /// Writes what is known of some jobs now, all or none. Those that are not there any more are left out.
    ///
    /// # Errors
    /// It could not be stored.
    pub fn save(&self, changed: &[Row]) -> io::Result<()> {
        let mut rows = self.rows();
        let transaction = rows.transaction().map_err(fault)?;
        for row in changed {
            let update = "UPDATE jobs SET record = ?2, trail = ?3 WHERE id = ?1";
            transaction.execute(update, params![row.id, row.record, row.trail]).map_err(fault)?;
        }
        transaction.commit().map_err(fault)
    }

    /// Forgets a job and its document.
    ///
    /// # Errors
    /// It is still there.
    pub fn remove(&self, id: &str) -> io::Result<()> {
        self.rows().execute("DELETE FROM jobs WHERE id = ?1", [id]).map_err(fault)?;
        self.remove_document(id);
        Ok(())
    }

    /// Removes a document that no job needs. What cannot be removed now goes at the next start.
    pub fn remove_document(&self, id: &str) {
        if let Err(error) = fs::remove_file(self.document(id)) {
            tracing::warn!("the document {id} cannot be removed: {error}");
        }
    }

    /// Whether something can be written.
    pub fn is_writable(&self) -> bool {
        self.rows().execute_batch("BEGIN IMMEDIATE; ROLLBACK").is_ok()
    }
}

/// SQLite's fault as one of the system's.
fn fault(error: rusqlite::Error) -> io::Error {
    // Only the want of room on the disk itself is told as that; past a quota or a limit of a file's size a write fails.
    const WRITE: i32 = rusqlite::ffi::SQLITE_IOERR_WRITE;
    if error.sqlite_error().is_some_and(|fault| fault.extended_code == WRITE) {
        return io::Error::new(io::ErrorKind::StorageFull, error);
    }
    match error.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => io::Error::from(io::ErrorKind::StorageFull),
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
            io::Error::new(io::ErrorKind::ResourceBusy, "another service uses this folder")
        }
        _ => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(id: &str) -> Row {
        Row { id: id.to_owned(), record: "{}".to_owned(), trail: vec![1, 2] }
    }

    #[test]
    fn a_job_is_there_with_its_document_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        store.write_document("a", b"one").unwrap();
        store.write_document("b", b"two").unwrap();
        assert_eq!(store.add(&row("a"), Some("k")).unwrap(), None);
        assert_eq!(store.add(&row("b"), Some("k")).unwrap().as_deref(), Some("a"), "the key has a job");
        fs::write(store.documents().join(".c.part"), b"thr").unwrap();
        assert_eq!(Store::open(folder.path()).unwrap_err().kind(), io::ErrorKind::ResourceBusy, "one service a folder");
        drop(store);

        let store = Store::open(folder.path()).unwrap();
        let names: Vec<_> = fs::read_dir(store.documents()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["a"], "what belongs to no job is gone");
        assert_eq!(fs::read(store.document("a")).unwrap(), b"one");
        store.save(&[Row { record: "[]".to_owned(), ..row("a") }, row("gone")]).unwrap();
        let all = store.all().unwrap();
        assert_eq!(all.iter().map(|row| (&*row.id, &*row.record, &*row.trail)).collect::<Vec<_>>(), [("a", "[]", &[1, 2][..])]);
        store.remove("a").unwrap();
        assert!(store.all().unwrap().is_empty() && !store.document("a").exists());
        assert!(store.is_writable());
    }
}
