"""back_up.py: makes a backup, and compares every byte of it with its checksums."""
import plant

with plant.connect("engineer") as client:
    backup = client.create_backup(progress=True)
    client.verify_backup(backup.name)
print(f"{backup.name}: revision {backup.catalog_revision}, {backup.view_count} views, {backup.byte_count} bytes")
