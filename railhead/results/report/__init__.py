"""What people read: tables on the terminal, the HTML report, labels and units."""
