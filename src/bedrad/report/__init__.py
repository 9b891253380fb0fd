"""What people look at: tables, figures, the summary in the terminal."""
