"""What every package uses: checks, files, texts, places."""
