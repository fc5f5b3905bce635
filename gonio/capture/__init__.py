"""Running a plan: calibration frames, then shot by shot, journaled and resumable."""
