"""What other packages' loaders hand out."""
