"""Result records to report.html."""
